"""One FMU with a binary for each platform: in the right folders, with what old systems have, and the same numbers.

`tests/run platforms` names in PLATFORMS what could be built and can be run here.
"""

import math
import os
import pathlib
import shutil
import struct
import subprocess
import xml.etree.ElementTree as ElementTree
import zipfile

import pytest
from elftools.elf.elffile import ELFFile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "target" / "release"
ZIG = [ROOT / "target/platforms/python/bin/python", "-m", "ziglang"]
PLATFORMS = os.environ["PLATFORMS"].split()
VERSIONS = ("2", "3")
FOLDERS = {
    "linux64": {"2": "linux64", "3": "x86_64-linux"},
    "win64": {"2": "win64", "3": "x86_64-windows"},
    "aarch64-linux": {"2": "aarch64-linux", "3": "aarch64-linux"},
}
ENDINGS = {"linux64": "so", "win64": "dll", "aarch64-linux": "so"}
TARGETS = {
    "linux64": "x86_64-linux-gnu.2.17",
    "win64": "x86_64-windows-gnu",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
}
EMULATORS = {
    "linux64": [],
    "win64": ["/usr/lib/wine/wine64"],
    "aarch64-linux": ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"],
}
# The dissertation's test, 55 rpm and 50 N, and what is compared; bits of all numbers at each of 60 seconds.
INPUTS = {"u": 3.1086, "N2": 50.0}
WATCHED = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"]
MODELS = {"ReducedRig": "reduced-rig.toml", "TwoGaussian": "reduced-rig-two-gaussian.toml"}


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """The FMUs with all platforms, unpacked, in MODEL/VERSION/, and the importers."""
    folder = tmp_path_factory.mktemp("platforms")
    wanted = [part for platform in PLATFORMS for part in ("--platform", platform)]
    for model, file in MODELS.items():
        command = [PROGRAMS / "build-fmu", ROOT / "modelDescription" / file, *wanted, "--out", folder / model]
        subprocess.run(command, check=True)
        for version in VERSIONS:
            with zipfile.ZipFile(folder / model / f"ReducedRig.fmi{version}.fmu") as archive:
                archive.extractall(folder / model / version)
    source = pathlib.Path(__file__).with_name("importer.c")
    for platform in PLATFORMS:
        output = folder / f"importer-{platform}.exe"
        libraries = [] if platform == "win64" else ["-ldl"]
        command = [*ZIG, "cc", "-std=c11", "-O1", "-target", TARGETS[platform], source, "-o", output, *libraries]
        subprocess.run(command, check=True)
    if "win64" in PLATFORMS:
        source = pathlib.Path(__file__).with_name("bcryptprimitives.c")
        command = [*ZIG, "cc", "-shared", "-target", TARGETS["win64"], source, "-o", folder / "bcryptprimitives.dll"]
        subprocess.run([*command, "-ladvapi32"], check=True)
    return folder


def binary(folder, model, version, platform):
    return folder / model / version / "binaries" / FOLDERS[platform][version] / f"ReducedRig.{ENDINGS[platform]}"


def run(folder, model, version, platform):
    """The 60 lines of bits that the importer writes."""
    unpacked = folder / model / version
    root = ElementTree.parse(unpacked / "modelDescription.xml").getroot()
    token = root.get("guid") or root.get("instantiationToken")
    references = {variable.get("name"): variable.get("valueReference") for variable in root.find("ModelVariables")}
    resources = f"{unpacked}/resources/"
    library = str(binary(folder, model, version, platform))
    if platform == "win64":  # wine shows the file system as drive Z:
        library, resources = f"Z:{library}".replace("/", "\\"), f"Z:{resources}".replace("/", "\\")
    if version == "2":
        resources = "file:///" + resources.replace("\\", "/").lstrip("/")
    arguments = [
        version,
        library,
        token,
        resources,
        ",".join(f"{references[name]}={value!r}" for name, value in INPUTS.items()),
        ",".join(references[name] for name in WATCHED),
    ]
    environment = {**os.environ, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all", "DISPLAY": ""}
    command = [*EMULATORS[platform], folder / f"importer-{platform}.exe", *arguments]
    result = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600)
    assert result.returncode == 0, result.stderr
    lines = result.stdout.split("\n")[:-1]
    assert len(lines) == 60
    return [[struct.unpack(">d", bytes.fromhex(word))[0] for word in line.split()] for line in lines]


@pytest.mark.parametrize("version", VERSIONS)
def test_each_binary_is_in_its_folder_and_no_other(folder, version):
    for model in MODELS:
        binaries = folder / model / version / "binaries"
        found = sorted(str(path.relative_to(binaries)) for path in binaries.rglob("*") if path.is_file())
        assert found == sorted(f"{FOLDERS[name][version]}/ReducedRig.{ENDINGS[name]}" for name in PLATFORMS)


def test_check_finds_nothing(folder):
    fmus = sorted(folder.glob("*/*.fmu"))
    result = subprocess.run([PROGRAMS / "build-fmu", "check", *fmus], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout
    assert result.stdout.count("nothing found") == len(fmus) == 4


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("platform", [name for name in PLATFORMS if name != "win64"])
def test_linux_libraries_need_no_newer_glibc_than_2_17(folder, platform, version):
    with open(binary(folder, "ReducedRig", version, platform), "rb") as file:
        library = ELFFile(file)
        needs = {need.name for need, _ in library.get_section_by_name(".gnu.version_r").iter_versions()}
        versions = {
            tuple(int(part) for part in wanted.name.removeprefix("GLIBC_").split("."))
            for _, wanteds in library.get_section_by_name(".gnu.version_r").iter_versions()
            for wanted in wanteds
            if wanted.name.startswith("GLIBC_")
        }
    print(f"{platform}, FMI {version}: glibc {'.'.join(str(part) for part in max(versions))} of {sorted(needs)}")
    assert versions and max(versions) <= (2, 17)
    assert not any("gcc_s" in name or "stdc++" in name for name in needs), needs


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", VERSIONS)
def test_all_platforms_give_the_same_numbers(folder, version, model):
    reference = run(folder, model, version, "linux64")
    assert max(line[1] for line in reference) > 8.0, "the disc must have slipped"
    for platform in PLATFORMS:
        found = run(folder, model, version, platform)
        differences = [
            abs(ours - theirs) / max(1.0, abs(ours))
            for ours_line, line in zip(reference, found, strict=True)
            for ours, theirs in zip(ours_line, line, strict=True)
        ]
        identical = sum(difference == 0.0 for difference in differences)
        print(f"{model}, FMI {version}, {platform}: {identical} of {len(differences)} numbers are the same bit for bit, "
              f"largest difference {max(differences):.1e}")
        assert not any(math.isnan(difference) for difference in differences)
        assert max(differences) <= 1e-12


# Mach-O: processors, kind of file and load commands.
PROCESSORS = {"darwin64": 0x01000007, "aarch64-darwin": 0x0100000C}
DYNAMIC_LIBRARY, LOAD, NAME, SIGNATURE, BUILD_VERSION = 6, 0xC, 0xD, 0x1D, 0x32


def load_commands(content):
    """Processor, kind and load commands of a library for macOS."""
    magic, processor, _, kind, count, *_ = struct.unpack_from("<8I", content)
    assert magic == 0xFEEDFACF
    commands, place = [], 32
    for _ in range(count):
        command, size = struct.unpack_from("<2I", content, place)
        commands.append((command, content[place : place + size]))
        place += size
    return processor, kind, commands


def text_of(command):
    return command[struct.unpack_from("<I", command, 8)[0] :].split(b"\0")[0].decode()


@pytest.mark.parametrize("platform", PROCESSORS)
def test_libraries_for_macos_have_the_right_headers_and_were_never_run(platform, tmp_path):
    """All functions of the standard are there, or build-fmu would refuse."""
    if not (PROGRAMS / "platforms" / platform).exists():
        pytest.skip(f"build-fmu/platforms/build {platform} did not work here")
    command = [PROGRAMS / "build-fmu", ROOT / "modelDescription/reduced-rig.toml", "--platform", platform]
    said = subprocess.run([*command, "--out", tmp_path], check=True, capture_output=True, text=True).stdout
    assert said.count(f"; {platform})") == 2, said
    for version, folder in (("2", platform), ("3", platform.replace("darwin64", "x86_64-darwin"))):
        with zipfile.ZipFile(tmp_path / f"ReducedRig.fmi{version}.fmu") as archive:
            content = archive.read(f"binaries/{folder}/ReducedRig.dylib")
            packed = sum(entry.compress_size for entry in archive.infolist())
        assert packed <= 900 * 1024
        processor, kind, commands = load_commands(content)
        assert (processor, kind) == (PROCESSORS[platform], DYNAMIC_LIBRARY)
        assert [text_of(c) for number, c in commands if number == LOAD] == ["/usr/lib/libSystem.B.dylib"]
        assert [text_of(c) for number, c in commands if number == NAME] == ["@rpath/fmu.dylib"]
        oldest = [struct.unpack_from("<2I", c, 8) for number, c in commands if number == BUILD_VERSION]
        assert oldest == [(1, 11 << 16)], "macOS 11"
        if platform == "aarch64-darwin":
            assert [number for number, _ in commands].count(SIGNATURE) == 1, "that system loads nothing unsigned"


def test_without_names_all_that_are_there_are_packed(tmp_path):
    for name in ("build-fmu", "libstickslip.so"):
        shutil.copy(PROGRAMS / name, tmp_path)
    for platform in PLATFORMS:
        shutil.copytree(PROGRAMS / "platforms" / platform, tmp_path / "platforms" / platform)
    command = [tmp_path / "build-fmu", ROOT / "modelDescription/reduced-rig.toml", "--fmi", "3", "--out", tmp_path]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    with zipfile.ZipFile(tmp_path / "ReducedRig.fmi3.fmu") as archive:
        found = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}
    assert found == {FOLDERS[name]["3"] for name in PLATFORMS}
    assert all(name in said for name in PLATFORMS), said


def test_a_missing_platform_is_told_with_the_command_that_makes_it(tmp_path):
    shutil.copy(PROGRAMS / "build-fmu", tmp_path)
    shutil.copy(PROGRAMS / "libstickslip.so", tmp_path)
    command = [tmp_path / "build-fmu", ROOT / "modelDescription/reduced-rig.toml", "--platform", "win64"]
    result = subprocess.run([*command, "--out", tmp_path / "out"], capture_output=True, text=True)
    assert result.returncode == 2
    assert "build-fmu/platforms/setup win64" in result.stderr and "build-fmu/platforms/build win64" in result.stderr
    assert not (tmp_path / "out").exists()


def test_libraries_built_elsewhere_go_where_their_header_says(tmp_path):
    libraries = [PROGRAMS / "platforms" / name / ("stickslip.dll" if name == "win64" else "libstickslip.so")
                 for name in PLATFORMS]
    copies = []
    for number, library in enumerate(libraries):
        copies.append(tmp_path / f"copy-{number}")
        shutil.copy(library, copies[-1])
    named = [part for copy in reversed(copies) for part in ("--library", copy)]
    command = [PROGRAMS / "build-fmu", ROOT / "modelDescription/reduced-rig.toml", "--fmi", "3", *named]
    subprocess.run([*command, "--out", tmp_path], check=True)
    with zipfile.ZipFile(tmp_path / "ReducedRig.fmi3.fmu") as archive:
        found = {name for name in archive.namelist() if name.startswith("binaries/")}
    assert found == {f"binaries/{FOLDERS[name]['3']}/ReducedRig.{ENDINGS[name]}" for name in PLATFORMS}
