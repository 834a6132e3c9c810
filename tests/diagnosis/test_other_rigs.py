"""Rigs of any size: the same case in other units of mass, force and time is the same case."""

import csv
import json
import pathlib
import subprocess
import tomllib

import pytest
from conftest import PROGRAMS, ROOT, diagnosed

CASE = ROOT / "crates" / "workbench" / "tests" / "data" / "unbalance"
# Exponents of mass and time of what model, records and instruments hold; lengths and currents stay.
UNITS = {
    "inertia": (1, 0),
    "stiffness": (1, -2),
    "damping": (1, -1),
    "resistance": (1, -3),
    "inductance": (1, -2),
    "torque_constant": (1, -2),
    "back_emf_constant": (1, -2),
    "coulomb_torque": (1, -2),
    "viscous_damping": (1, -1),
    "omega_s": (0, -1),
    "time": (0, 1),
    "u": (1, -3),
    "N2": (1, -2),
    "theta_dot": (0, -1),
    "theta3_dot": (0, -1),
    "disc_velocity_noise": (0, -1),
    "gear_velocity_noise": (0, -1),
    "load_cell_noise": (1, -2),
}
SENSORS = {
    "disc_encoder_step": 0.0062831853,
    "gear_encoder_step": 0.00078539816,
    "disc_velocity_noise": 0.05,
    "gear_velocity_noise": 0.00625,
    "load_cell_noise": 0.2,
}


def scaled(name, value, mass, time):
    of_mass, of_time = UNITS.get(name, (0, 0))
    return value * mass**of_mass * time**of_time


def write_scaled(folder, mass, time):
    """The case of the tests with every mass and every time multiplied."""
    model = tomllib.loads((CASE / "model.toml").read_text())
    lines = []
    for section, keys in model.items():
        lines.append(f"[{section}]")
        for key, value in keys.items():
            text = f'"{value}"' if isinstance(value, str) else repr(float(scaled(key, value, mass, time)))
            lines.append(f"{key} = {text}")
    folder.mkdir()
    (folder / "model.toml").write_text("\n".join(lines) + "\n")
    sensors = [f"{key} = {scaled(key, value, mass, time)!r}" for key, value in SENSORS.items()]
    (folder / "sensors.toml").write_text("\n".join(sensors) + "\n")
    for path in CASE.glob("*.csv"):
        with path.open() as file, (folder / path.name).open("w") as out:
            rows = csv.reader(file)
            names = next(rows)
            out.write(",".join(names) + "\n")
            for row in rows:
                values = (scaled(name, float(text), mass, time) for name, text in zip(names, row))
                out.write(",".join(repr(value) for value in values) + "\n")


def finding_of(folder, mass, time):
    write_scaled(folder / "case", mass, time)
    out = folder / "result"
    done = subprocess.run([PROGRAMS / "stickslip", "name", folder / "case", "--out", out], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((pathlib.Path(out) / "finding.json").read_text())


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    return finding_of(tmp_path_factory.mktemp("reference"), 4.0, 0.5)


@pytest.mark.parametrize("mass, time", [(1e6, 20.0), (1e-4, 0.05)])
def test_the_size_of_a_rig_changes_no_name_and_no_relative_interval(tmp_path, reference, mass, time):
    finding = finding_of(tmp_path, mass, time)
    assert finding["verdict"] == reference["verdict"] == "named"
    assert [effect["name"] for effect in finding["effects"]] == ["unbalance"]
    for effect, same in zip(finding["effects"], reference["effects"]):
        assert effect["probability"] == pytest.approx(same["probability"], abs=0.01)
        for name, number in effect["parameters"].items():
            other = same["parameters"][name]
            low, high = (bound / number["value"] for bound in number["interval95"])
            assert low == pytest.approx(other["interval95"][0] / other["value"], rel=0.01)
            assert high == pytest.approx(other["interval95"][1] / other["value"], rel=0.01)


def test_a_rig_of_another_size_and_instruments_is_diagnosed(tmp_path):
    case = diagnosed(tmp_path, "viscous_drag", "viscous_drag", 910_001, "--other-rigs")
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == ["viscous_drag"], case.screen
    assert finding["gap"]["held_out"]["closed"] > 0.9
    # The set that is named is the most probable of all that were tried.
    probabilities = [rival["probability"] for rival in finding["ranking"]]
    assert probabilities[0] == max(probabilities) and sum(probabilities) == pytest.approx(1.0)


def test_a_rig_of_another_size_that_lacks_nothing_is_left_in_peace(tmp_path):
    case = diagnosed(tmp_path, "none", "none", 910_101, "--other-rigs", "--clean")
    assert case.finding["effects"] == [], case.screen
    assert case.finding["verdict"] in ("nothing_missing", "parameters")
