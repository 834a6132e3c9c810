"""What is in the FMUs: valid, complete, the same bytes every time."""

import html.parser
import pathlib
import subprocess
import tomllib
import zipfile

import fmpy
import fmpy.validation
import pytest
from conftest import MODELS, PROGRAMS, ROOT, VERSIONS, build
from lxml import etree

BINARIES = {"fmi2": "binaries/linux64", "fmi3": "binaries/x86_64-linux"}


def test_validation_finds_nothing(each_fmu):
    assert fmpy.validation.validate_fmu(str(each_fmu)) == []


def test_info_can_be_shown(each_fmu):
    result = subprocess.run(
        [pathlib.Path(fmpy.sys.executable), "-m", "fmpy", "info", each_fmu],
        capture_output=True, text=True,
    )
    assert result.returncode == 0, result.stderr
    assert "Co-Simulation" in result.stdout


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_files_are_where_the_standard_wants_them(fmus, model, version):
    with zipfile.ZipFile(fmus[model, version]) as archive:
        names = set(archive.namelist())
        assert archive.testzip() is None
        resource = archive.read("resources/model.toml")
    expected = {"modelDescription.xml", "documentation/index.html", "resources/model.toml",
                f"{BINARIES[version]}/{model}.so"}
    if version == "fmi2":
        expected |= {"model.png", "licenses/license.txt"}
    else:
        expected |= {"terminalsAndIcons/icon.png", "terminalsAndIcons/terminalsAndIcons.xml",
                     "documentation/licenses/license.txt"}
    assert expected <= names
    assert resource == MODELS[model].read_bytes()


def test_archive_suits_every_unpacker(each_fmu):
    with zipfile.ZipFile(each_fmu) as archive:
        for entry in archive.infolist():
            assert entry.extract_version <= 20, entry
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED), entry
            assert entry.date_time == (1980, 1, 1, 0, 0, 0), entry
            assert "\\" not in entry.orig_filename and not entry.is_dir(), entry
            assert (entry.external_attr >> 28) in (0, 0o10), f"{entry} is not a plain file"


def test_second_build_gives_the_same_bytes(fmus, tmp_path):
    for model in MODELS.values():
        assert build(model, tmp_path).returncode == 0
    for path in fmus.values():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_model_description_equals_the_kept_copy(fmus, model, version):
    kept = ROOT / "modelDescription" / f"{model}.{version}.xml"
    with zipfile.ZipFile(fmus[model, version]) as archive:
        assert archive.read("modelDescription.xml") == kept.read_bytes(), (
            f"regenerate with: target/release/build-fmu {MODELS[model].relative_to(ROOT)} "
            "--write-xml modelDescription"
        )


@pytest.mark.parametrize("model", MODELS)
def test_terminals_follow_the_schema_and_name_variables(fmus, model):
    path = fmus[model, "fmi3"]
    schema = etree.XMLSchema(
        file=str(pathlib.Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd")
    )
    with zipfile.ZipFile(path) as archive:
        document = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    schema.assertValid(document)
    known = {variable.name for variable in fmpy.read_model_description(str(path)).modelVariables}
    members = {member.get("variableName") for member in document.iter("TerminalMemberVariable")}
    assert members and members <= known


class Balance(html.parser.HTMLParser):
    """Counts open elements and collects text and references to other files."""

    VOID = {"meta", "br", "img", "link"}

    def __init__(self):
        super().__init__()
        self.open, self.text, self.references = [], [], []

    def handle_starttag(self, tag, attributes):
        self.references += [value for name, value in attributes if name in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def test_documentation_is_one_complete_page(each_fmu):
    with zipfile.ZipFile(each_fmu) as archive:
        page = archive.read("documentation/index.html").decode()
        names = archive.namelist()
    parser = Balance()
    parser.feed(page)
    assert parser.open == []
    assert [f"documentation/{name}" in names for name in parser.references] == [True]
    text = "".join(parser.text)
    for variable in fmpy.read_model_description(str(each_fmu)).modelVariables:
        assert variable.name in text


def test_units_are_si_with_display_units(reduced_rig):
    units = {unit.name: unit for unit in fmpy.read_model_description(str(reduced_rig)).unitDefinitions}
    assert units["N.m"].baseUnit.kg == 1 and units["N.m"].baseUnit.m == 2 and units["N.m"].baseUnit.s == -2
    assert [unit.name for unit in units["rad/s"].displayUnits] == ["rpm"]
    assert [unit.name for unit in units["rad"].displayUnits] == ["deg"]


def numbers(table, prefix=""):
    """Dotted names and values of all numbers of a model file."""
    for key, value in table.items():
        if isinstance(value, dict) and "value" not in value:
            yield from numbers(value, f"{prefix}{key}.")
        else:
            number = value["value"] if isinstance(value, dict) else value
            if isinstance(number, (int, float)):
                yield prefix + key, float(number)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_every_number_of_the_model_file_is_a_parameter(fmus, model, version):
    variables = fmpy.read_model_description(str(fmus[model, version])).modelVariables
    parameters = {v.name: v for v in variables if v.causality == "parameter"}
    expected = dict(numbers(tomllib.loads(MODELS[model].read_text())))
    assert {name: float(v.start) for name, v in parameters.items()} == expected
    assert all(v.description and v.unit for v in parameters.values())


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("[disc]\n", "[disc]\nmass = 4.5\n", ["[disc] has no key \"mass\"", "known are inertia"]),
        ("[gearbox]", "[gear_box]", ["there is no section [gear_box]", "known are disc"]),
        ('law = "stribeck"', "", ["[contact] lacks law", "one of coulomb"]),
        ("value = 0.0149", "value = -1.0", ["disc.inertia = -1 is out of range", "above 0"]),
        ("value = 0.0149", "value = nan", ["disc.inertia = NaN is out of range", "above 0"]),
        ("[disc]", "[disc", ["not valid TOML", "line"]),
    ],
)
def test_model_file_that_is_wrong_is_refused_and_nothing_is_written(tmp_path, old, new, expected):
    text = MODELS["ReducedRig"].read_text()
    assert old in text
    model = tmp_path / "wrong.toml"
    model.write_text(text.replace(old, new, 1))
    out = tmp_path / "out"
    out.mkdir()
    kept = out / "ReducedRig.fmi2.fmu"
    kept.write_bytes(b"from an earlier build")
    result = build(model, out)
    assert result.returncode == 2
    for part in [str(model), *expected]:
        assert part in result.stderr
    assert list(out.iterdir()) == [kept] and kept.read_bytes() == b"from an earlier build"


def test_library_is_named_when_it_is_missing(tmp_path):
    program = tmp_path / "build-fmu"
    program.write_bytes((PROGRAMS / "build-fmu").read_bytes())
    program.chmod(0o755)
    result = subprocess.run(
        [program, MODELS["ReducedRig"], "--out", tmp_path / "out"], capture_output=True, text=True
    )
    assert result.returncode == 2
    assert str(tmp_path / "libstickslip.so") in result.stderr and "--library" in result.stderr
    assert not (tmp_path / "out").exists()


def test_library_beside_the_program_is_enough(tmp_path):
    for name in ("build-fmu", "libstickslip.so"):
        (tmp_path / name).write_bytes((PROGRAMS / name).read_bytes())
    (tmp_path / "build-fmu").chmod(0o755)
    result = subprocess.run(
        [tmp_path / "build-fmu", MODELS["ReducedRig"], "--out", "out"],
        capture_output=True, text=True, cwd=tmp_path, env={"PATH": ""},
    )
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out" / "ReducedRig.fmi2.fmu").is_file()


def test_what_lies_among_the_platforms_is_packed_or_refused_without_being_named(tmp_path):
    for name in ("build-fmu", "libstickslip.so"):
        (tmp_path / name).write_bytes((PROGRAMS / name).read_bytes())
    (tmp_path / "build-fmu").chmod(0o755)
    spoiled = tmp_path / "platforms" / "win64" / "stickslip.dll"
    spoiled.parent.mkdir(parents=True)
    spoiled.write_text("no library")
    command = [tmp_path / "build-fmu", MODELS["ReducedRig"], "--out", tmp_path / "out"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 2 and str(spoiled) in result.stderr
    spoiled.unlink()
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0 and result.stdout.count(" KiB; linux64)") == 2


def test_foreign_library_is_refused(tmp_path):
    foreign = pathlib.Path(fmpy.__file__).parent / "sundials" / "x86_64-linux" / "sundials_core.so"
    result = subprocess.run(
        [PROGRAMS / "build-fmu", MODELS["ReducedRig"], "--out", tmp_path, "--library", foreign],
        capture_output=True, text=True,
    )
    assert result.returncode == 2
    assert "fmi2Instantiate" in result.stderr and "lacks" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_check_finds_nothing_in_our_fmus(fmus):
    result = subprocess.run([PROGRAMS / "build-fmu", "check", *fmus.values()], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout
    assert result.stdout.count("nothing found") == len(fmus)


@pytest.mark.parametrize("version", VERSIONS)
def test_date_of_generation_is_the_one_that_reproducible_builds_name(tmp_path, monkeypatch, version):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    first, second = tmp_path / "a", tmp_path / "b"
    assert build(MODELS["ReducedRig"], first).returncode == 0
    path = first / f"ReducedRig.{version}.fmu"
    assert fmpy.read_model_description(str(path)).generationDateAndTime == "2023-11-14T22:13:20Z"
    assert fmpy.validation.validate_fmu(str(path)) == []
    assert build(MODELS["ReducedRig"], second).returncode == 0
    assert path.read_bytes() == (second / path.name).read_bytes()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    result = build(MODELS["ReducedRig"], tmp_path / "c")
    assert result.returncode == 2 and "number of seconds since 1970-01-01" in result.stderr


INSTANTIATE = """
import ctypes, sys
library, token, location = sys.argv[1:]
lines = []
@ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
def log(environment, status, category, message):
    lines.append((status, message.decode()))
library = ctypes.CDLL(library)
library.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
instance = library.fmi3InstantiateCoSimulation(
    b"rig", token.encode(), location.encode(), False, False, False, False, None, ctypes.c_size_t(0), None, log, None)
print(bool(instance), lines)
"""


def test_wrong_resource_location_is_answered_with_the_library_s_own_folder(fmus, tmp_path):
    """And says so, as the standard's warning (1); not with another token, and not with another model."""
    fmu = fmus["ReducedRig", "fmi3"]
    fmpy.extract(str(fmu), unzipdir=str(tmp_path))
    token = fmpy.read_model_description(str(fmu)).instantiationToken
    library = tmp_path / BINARIES["fmi3"] / "ReducedRig.so"

    def instantiate(token, location):
        command = [fmpy.sys.executable, "-c", INSTANTIATE, library, token, location]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    assert instantiate(token, str(tmp_path / "resources")).startswith("True []")
    for wrong in ("/nowhere", "file://nowhere/resources", "resources"):
        said = instantiate(token, wrong)
        assert said.startswith("True [(1, ") and "is taken instead" in said and wrong in said, said
        assert instantiate("{" + token[2:], wrong).startswith("False [(3, ")
    (tmp_path / "resources" / "model.toml").unlink()
    assert instantiate(token, "/nowhere").startswith("False [(3, ")
