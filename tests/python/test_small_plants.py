"""Drives, pendulums and joints as FMUs: valid, the same in both versions, right by closed forms."""

import math
import subprocess

import fmpy
import numpy
import pytest
from conftest import PROGRAMS, VERSIONS, build
from fmpy.validation import validate_fmu

PLANTS = {
    "Drive": """
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 2.0
viscous = 0.0
offset = 0.0
[elastic_force]
linear = 50.0
square = 0.0
[coulomb_friction]
force = 3.0
""",
    "Pendulum": """
[plant]
kind = "pendulum"
path = "turn"
[pendulum]
stiffness = { value = 40.0, unit = "1/s2" }
rest = 0.1
viscous = 0.05
[coulomb_friction]
force = 0.4
[[effect]]
name = "magnet"
title = "a magnet below"
port = "plant.force"
equation = "pull * sin(3*position) / (1 + (velocity/fast)^2)"
parameters.pull = { value = 2.0, unit = "force", description = "its size" }
parameters.fast = { value = 5.0, unit = "speed", range = "positive", description = "speed above which it is weak" }
""",
    "Joint": """
[plant]
kind = "joint"
path = "turn"
[joint]
stiffness = 72.0
rest = 0.0
viscous = 1.0
gain = 15.0
back_emf = 10.0
[motor_load_friction]
coefficient = 0.2
[friction_wear]
rate_per_minute = 0.5
""",
}


@pytest.fixture(scope="module")
def plants(tmp_path_factory):
    """Paths of the FMUs by (model, version)."""
    folder = tmp_path_factory.mktemp("plants")
    for name, text in PLANTS.items():
        model = folder / f"{name}.toml"
        model.write_text(text)
        result = build(model, folder)
        assert result.returncode == 0, result.stderr
    return {
        (name, version): folder / f"{name}.{version}.fmu" for name in PLANTS for version in VERSIONS
    }


def run(path, stop, step=0.01, inputs=None, **start):
    return fmpy.simulate_fmu(
        str(path),
        stop_time=stop,
        step_size=step,
        output_interval=step,
        start_values=start,
        input=inputs,
        output=["position", "velocity", "friction", "acceleration", "stuck"],
    )


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("version", VERSIONS)
def test_validates(plants, name, version):
    problems = validate_fmu(str(plants[name, version]))
    assert problems == []
    command = [PROGRAMS / "build-fmu", "check", plants[name, version]]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout


@pytest.mark.parametrize("version", VERSIONS)
def test_a_mass_on_a_spring_comes_to_rest_where_friction_holds_it(plants, version):
    half_swing = math.pi / 5.0
    result = run(plants["Drive", version], 10 * half_swing, half_swing / 10, position=1.0)
    for swings in range(9):
        expected = (-1) ** swings * (1.0 - 0.12 * swings)
        assert abs(result["position"][10 * swings] - expected) < 1e-9
    assert result["stuck"][-1] and result["velocity"][-1] == 0.0


@pytest.mark.parametrize("name", PLANTS)
def test_both_versions_give_the_same_numbers(plants, name):
    inputs = None
    if name == "Joint":
        times = numpy.arange(0.0, 5.0, 0.01)
        values = [(time, 8.0 * math.sin(2.0 * time), 1.0) for time in times]
        inputs = numpy.array(values, dtype=[("time", float), ("voltage", float), ("connected", float)])
    old, new = (run(plants[name, version], 5.0, inputs=inputs, position=0.6) for version in VERSIONS)
    for quantity in ("position", "velocity", "friction", "acceleration"):
        assert numpy.max(numpy.abs(old[quantity] - new[quantity])) <= 1e-12, quantity
    assert numpy.ptp(old["position"]) > 0.1


def test_parameters_have_dotted_names_units_and_ranges(plants):
    description = fmpy.read_model_description(str(plants["Pendulum", "fmi3"]))
    variables = {variable.name: variable for variable in description.modelVariables}
    assert variables["pendulum.stiffness"].unit == "1/s2"
    assert variables["magnet.fast"].unit == "rad/s"
    assert variables["magnet.fast"].min == "0"
    assert variables["coulomb_friction.force"].description == "friction while sliding"


@pytest.mark.parametrize("kind, reason", [
    ("balance", "your own model, which stays yours"),
    ("contact", "a law without a body"),
])
def test_what_does_not_move_by_itself_is_refused(tmp_path, kind, reason):
    model = tmp_path / "model.toml"
    model.write_text(f'[plant]\nkind = "{kind}"\npath = "turn"\n')
    result = build(model, tmp_path)
    assert result.returncode == 2 and reason in result.stderr, result.stderr
    assert not list(tmp_path.glob("*.fmu"))
