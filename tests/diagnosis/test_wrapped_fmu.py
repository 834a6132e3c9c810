"""An FMU around a foreign FMU in FMPy: valid, and its states can be saved, restored and serialised."""

import os
import pathlib
import shutil
import subprocess
import zipfile

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "target" / "release"
SPRING = ROOT / "crates" / "workbench" / "tests" / "wrapped_fmu"

# A second effect beside that of the file.
DRAG = """
[quadratic_drag]
coefficient = 0.02
"""


@pytest.fixture(scope="module")
def wrapped(tmp_path_factory):
    """The spring as an FMU of another exporter, with friction and drag around it."""
    place = tmp_path_factory.mktemp("wrapped")
    library = place / "Spring.so"
    rustc = os.environ.get("RUSTC", "rustc")
    subprocess.run([rustc, "--edition", "2024", "--crate-type", "cdylib", "-O", SPRING / "spring.rs", "-o", library], check=True)
    with zipfile.ZipFile(place / "spring.fmu", "w") as archive:
        archive.write(SPRING / "spring.xml", "modelDescription.xml")
        archive.write(library, "binaries/x86_64-linux/Spring.so")
    (place / "ports.toml").write_text((SPRING / "ports.toml").read_text() + DRAG)
    subprocess.run([PROGRAMS / "stickslip", "build", place / "ports.toml", "--out", place], check=True)
    return place / "spring.amended.fmu"


def test_it_is_valid(wrapped):
    assert validate_fmu(wrapped) == []
    checked = subprocess.run([PROGRAMS / "build-fmu", "check", wrapped], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_the_original_and_the_effects_are_run(wrapped):
    names = ["x", "v", "effects.force"]
    result = fmpy.simulate_fmu(wrapped, stop_time=60, output_interval=0.5, output=names)
    assert abs(result["x"][-1]) < 0.15, "friction holds it where the spring is weaker"
    assert abs(result["v"][-1]) < 1e-12
    assert result["effects.force"][-1] == pytest.approx(result["x"][-1], abs=1e-9)
    without = {"effects.coulomb_friction.force": 0.0, "effects.quadratic_drag.coefficient": 0.0}
    free = fmpy.simulate_fmu(wrapped, stop_time=60, output_interval=0.5, output=names, start_values=without)
    assert max(abs(free["x"][-13:])) > 0.9


def test_states_are_saved_restored_and_serialised(wrapped):
    description = fmpy.read_model_description(wrapped)
    folder = fmpy.extract(wrapped)
    references = [v.valueReference for v in description.modelVariables if v.name in ("x", "v", "effects.force")]

    def begun():
        fmu = FMU3Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="spring",
        )
        fmu.instantiate()
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def stepped(fmu, start, count):
        for at in range(start, start + count):
            fmu.doStep(currentCommunicationPoint=0.05 * at, communicationStepSize=0.05)
        return fmu.getFloat64(references)

    fmu = begun()
    stepped(fmu, 0, 30)
    state = fmu.getFMUState()
    once = stepped(fmu, 30, 40)
    fmu.setFMUState(state)
    assert stepped(fmu, 30, 40) == once
    content = fmu.serializeFMUState(state)
    other = begun()
    copy = other.deserializeFMUState(content)
    other.setFMUState(copy)
    assert stepped(other, 30, 40) == once
    fmu.reset()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    assert stepped(fmu, 0, 70) == once
    for instance, states in ((fmu, [state]), (other, [copy])):
        for own in states:
            instance.freeFMUState(own)
        instance.terminate()
        instance.freeInstance()
    shutil.rmtree(folder)


AXIS = """
[plant]
kind = "fmu"
path = "turn"
fmu = "axis.fmu"

[port]
input = "torque"
position = "phi"
velocity = "w"
inertia = 0.02
coupling_step = 0.001

[inputs]
voltage = { column = "u", unit = "V", between = "linear" }

[columns]
time = { column = "t", unit = "s" }
position = { column = "angle", unit = "rad" }

[measurement]
motion_low_pass = 20.0
compare_low_pass = 10.0
compare_rate = 40.0

[coulomb_friction]
force = 0.2
"""


def test_an_fmu_of_version_2_that_cannot_save_its_state(tmp_path):
    maker = [PROGRAMS / "benchmark-data", "make", "--fmu", "--seed", "700", "--cases", "1", "--out", tmp_path / "cases"]
    subprocess.run(maker, check=True, capture_output=True)
    (original,) = (tmp_path / "cases").rglob("axis.fmu")
    shutil.copy(original, tmp_path / "axis.fmu")
    (tmp_path / "ports.toml").write_text(AXIS)
    subprocess.run([PROGRAMS / "stickslip", "build", tmp_path / "ports.toml", "--out", tmp_path], check=True)
    wrapped = tmp_path / "axis.amended.fmu"
    assert validate_fmu(wrapped) == []
    start = {"voltage": 2.0, "torque": 0.0, "J": 0.02}
    names = ["phi", "w", "effects.force"]
    run = fmpy.simulate_fmu(wrapped, stop_time=4, output_interval=0.1, start_values=start, output=names)
    # Friction of the same size inside the axis, and none around it.
    inside = {"friction": 0.2, "effects.coulomb_friction.force": 0.0, **start}
    same = fmpy.simulate_fmu(wrapped, stop_time=4, output_interval=0.1, start_values=inside, output=names)
    assert max(abs(run["phi"] - same["phi"])) < 2e-3
    assert max(abs(same["effects.force"])) == 0.0 < max(abs(run["effects.force"]))
