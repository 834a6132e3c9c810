"""FMUs of the rigs and controllers, built by the shipped `build-fmu` from the shipped model files."""

import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "target" / "release"
MODELS = {
    "ReducedRig": ROOT / "modelDescription" / "reduced-rig.toml",
    "FullRig": ROOT / "modelDescription" / "full-rig.toml",
    "SpeedController": ROOT / "modelDescription" / "speed-controller.toml",
    "SoftTorque": ROOT / "modelDescription" / "soft-torque.toml",
}
VERSIONS = ("fmi2", "fmi3")


def build(model, folder):
    """Runs build-fmu for a model file; returns the finished process."""
    command = [PROGRAMS / "build-fmu", model, "--out", folder]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture(scope="session")
def fmus(tmp_path_factory):
    """Paths of the FMUs by (model, version)."""
    folder = tmp_path_factory.mktemp("fmus")
    for model in MODELS.values():
        result = build(model, folder)
        assert result.returncode == 0, result.stderr
    return {
        (model, version): folder / f"{model}.{version}.fmu"
        for model in MODELS
        for version in VERSIONS
    }


@pytest.fixture(params=[(model, version) for model in MODELS for version in VERSIONS],
                ids=lambda key: ".".join(key))
def each_fmu(request, fmus):
    """Every FMU in turn."""
    return fmus[request.param]


@pytest.fixture(params=VERSIONS)
def reduced_rig(request, fmus):
    """The reduced rig in both versions."""
    return fmus["ReducedRig", request.param]
