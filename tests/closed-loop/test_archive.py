"""The system structure archive: valid by the standard's schema, the same bytes every time, runs in FMPy."""

import pathlib
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


@pytest.mark.parametrize("options", [[], ["--expose"], ["--fmi", "3"], ["--start", "N2=50", "--start", "omega_ref=3"]])
def test_description_follows_the_schema(tmp_path, options):
    result = pack(tmp_path, *options)
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


def test_what_cannot_be_connected_is_refused(tmp_path):
    result = pack(tmp_path, models=[MODELS[0]])
    assert result.returncode == 2 and "two components" in result.stderr
    result = pack(tmp_path, "--start", "u=3")
    assert result.returncode == 2 and "free inputs are N2, omega_ref" in result.stderr
    assert list(tmp_path.iterdir()) == []
