"""The system structure archive: valid by the standard's schema, the same bytes every time, runs in FMPy and OMSimulator."""

import csv
import os
import pathlib
import re
import shutil
import subprocess
import zipfile

import fmpy
import fmpy.ssp
import fmpy.validation
import numpy
import pytest
from fmpy.ssp.simulation import simulate_ssp
from lxml import etree

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = [ROOT / "modelDescription" / f"{model}.toml" for model in ("reduced-rig", "soft-torque")]


def pack(out, *options, models=MODELS):
    command = [ROOT / "target/release/build-fmu", "ssp", *models, *options, "--out", out]
    return subprocess.run(command, capture_output=True, text=True)


STARTS = ["--start", "N2=50", "--start", "omega_ref=3"]


def description(archive):
    with zipfile.ZipFile(archive) as content:
        return etree.fromstring(content.read("SystemStructure.ssd"))


@pytest.mark.parametrize("models", [MODELS, MODELS[:1], MODELS[1:]])
@pytest.mark.parametrize("options", [[], ["--expose"], ["--fmi", "3"], STARTS, [*STARTS, "--expose"]])
def test_description_follows_the_schema(tmp_path, options, models):
    if len(models) == 1:
        here, elsewhere = ("N2=50", "omega_ref=3") if models == MODELS[:1] else ("omega_ref=3", "N2=50")
        options = [here if option == elsewhere else option for option in options]
        options = options if options[:1] != ["--start"] else options[2:]
    result = pack(tmp_path, *options, models=models)
    assert result.returncode == 0, result.stderr
    schema = pathlib.Path(fmpy.ssp.__file__).parent / "schema" / "SystemStructureDescription.xsd"
    with zipfile.ZipFile(result.stdout.strip()) as archive:
        etree.XMLSchema(file=str(schema)).assertValid(etree.fromstring(archive.read("SystemStructure.ssd")))
        for name in archive.namelist():
            if name.endswith(".fmu"):
                assert fmpy.validation.validate_fmu(archive.extract(name, tmp_path)) == []


def test_second_archive_has_the_same_bytes(tmp_path):
    first, second = (pathlib.Path(pack(tmp_path / folder).stdout.strip()) for folder in "ab")
    assert first.read_bytes() == second.read_bytes()


def test_exposed_system_runs_in_fmpy(tmp_path):
    archive = pack(tmp_path, "--expose").stdout.strip()
    inputs = {"omega_ref": lambda _: 5.0, "N2": lambda _: 50.0}
    result = simulate_ssp(archive, stop_time=20.0, step_size=0.002, input=inputs)
    late = result["theta_dot"][result["time"] > 15.0]
    assert numpy.abs(late - 5.0).max() < 1e-3


def test_exposed_start_values_are_those_of_the_system_too(tmp_path):
    root = description(pack(tmp_path, *STARTS, "--start", "disc.inertia=0.02", "--expose").stdout.strip())
    values = {parameter.get("name"): float(parameter[0].get("value")) for parameter in root.xpath(
        "/*/*[local-name()='System']/*[local-name()='ParameterBindings']//*[local-name()='Parameter']")}
    assert values == {"N2": 50.0, "omega_ref": 3.0}
    inner = root.xpath("//*[local-name()='Component']//*[local-name()='Parameter']/@name")
    assert sorted(inner) == ["N2", "disc.inertia", "omega_ref"]


@pytest.mark.parametrize("models, name", [(MODELS, "ReducedRig_SoftTorque"), (MODELS[:1], "ReducedRig")])
def test_names_are_identifiers_and_the_master_is_named(tmp_path, models, name):
    """What OMSimulator's command line reads of an archive, checked without it."""
    archive = pathlib.Path(pack(tmp_path, models=models).stdout.strip())
    root = description(archive)
    assert archive.name == f"{name}.fmi2.ssp" and root.get("name") == name
    names = root.xpath("//*[local-name()='System' or local-name()='Component']/@name")
    assert len(names) == 1 + len(models)
    assert all(re.fullmatch("[a-zA-Z][a-zA-Z0-9_]*", each) for each in [*names, name])
    [annotation] = root.xpath("/*/*[local-name()='System']/*[local-name()='Annotations']/*")
    assert annotation.get("type") == "org.openmodelica"
    [master] = annotation.xpath("*[local-name()='SimulationInformation']/*[local-name()='FixedStepMaster']")
    assert master.get("description") == "oms-ma"
    assert 0.0 < float(master.get("stepSize")) <= 0.01
    assert float(master.get("relativeTolerance")) == 1e-10


OMSIMULATOR = os.environ.get("OMSIMULATOR") or shutil.which("OMSimulator")


@pytest.mark.skipif(OMSIMULATOR is None, reason="no OMSimulator on PATH or in OMSIMULATOR: its package fetches it from its own server")
@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("options", [[], ["--expose"]])
def test_system_runs_in_omsimulator(tmp_path, version, options):
    starts = ["--start", "N2=50", "--start", "omega_ref=5.0"]
    archive = pack(tmp_path, *starts, *options, "--fmi", version).stdout.strip()
    command = [OMSIMULATOR, "--stopTime=20", "--stepSize=0.001", "--resultFile=result.csv", archive]
    subprocess.run(command, check=True, cwd=tmp_path)
    with open(tmp_path / "result.csv") as file:
        head, *rows = csv.reader(file)
    [column] = [place for place, name in enumerate(head) if name.endswith("ReducedRig.theta_dot")]
    late = [float(row[column]) for row in rows if float(row[0]) > 15.0]
    assert len(late) > 1000
    assert max(abs(value - 5.0) for value in late) < 1e-3


def test_what_cannot_be_connected_is_refused(tmp_path):
    rigs = [MODELS[0], MODELS[0].with_name("full-rig.toml")]
    result = pack(tmp_path, models=rigs)
    assert result.returncode == 2 and "both ReducedRig and FullRig have an output" in result.stderr
    result = pack(tmp_path, "--start", "u=3")
    assert result.returncode == 2 and "free inputs are N2, omega_ref" in result.stderr
    assert list(tmp_path.iterdir()) == []
