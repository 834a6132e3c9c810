"""What the dissertation found out by hand, found by one command; and its amended FMUs in another importer."""

import json
import math
import subprocess
import tomllib

import fmpy
import jsonschema
import numpy as np
import pytest
from conftest import PROGRAMS, ROOT

SCHEMA = json.loads((ROOT / "docs" / "finding.schema.json").read_text())
LAW_NUMBERS = ("a1", "b1", "c1", "a2", "b2", "c2", "omega_centre", "acceleration_semi_axis")


def amended(discovery):
    return tomllib.loads((discovery.out / "model.amended.toml").read_text())


def test_the_effect_is_named_and_the_gap_closed(discovery):
    assert discovery.exit_code == 0, discovery.screen
    finding = discovery.finding
    assert finding["verdict"] == "named"
    assert [effect["name"] for effect in finding["effects"]] == [discovery.effect]
    assert finding["ranking"][0]["name"] == discovery.effect
    assert finding["gap"]["through_fmu"]["closed"] > 0.98
    assert finding["gap"]["held_out"]["closed"] > 0.98


def test_the_finding_keeps_to_its_schema(discovery):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.Draft202012Validator(SCHEMA).validate(discovery.finding)


def test_a_wrong_finding_breaks_the_schema(discovery):
    validator = jsonschema.Draft202012Validator(SCHEMA)
    for change in (
        {"verdict": "maybe"},
        {"effects": []},
        {"alternatives": ["stribeck", "stiction"]},
        {"gap": {}},
        {"extra": 1},
    ):
        assert not validator.is_valid({**discovery.finding, **change}), change


def test_the_size_is_right(discovery):
    sizes = {name: value for name, value in discovery.truth["effects"].items() if not name.endswith("_ph")}
    (effect,) = discovery.finding["effects"]
    for name, value in sizes.items():
        found = effect["parameters"][name]
        assert math.isclose(found["value"], value, rel_tol=0.05), (name, found, value)


def test_the_amended_model_carries_the_fitted_numbers(discovery):
    model = amended(discovery)
    for name, value in discovery.finding["effects"][0]["parameters"].items():
        section, key = value["model_parameter"].split(".")
        entry = model[section][key]
        number = entry["value"] if isinstance(entry, dict) else entry
        assert math.isclose(number, value["value"], rel_tol=1e-12), name
        if value["interval95"] is not None:
            assert entry["status"] == "fitted"
            assert entry["interval95"] == pytest.approx(value["interval95"], rel=1e-12)
    if discovery.effect == "acceleration_hysteresis":
        assert model["contact"]["law"] == "two_gaussian_mu"
        assert all(model["contact"][key]["status"] == "fitted" for key in LAW_NUMBERS)


def run_natively(discovery):
    """The amended model under the held-out record's inputs, by `stickslip simulate`."""
    out = discovery.out / "native"
    if not out.exists():
        model, inputs = discovery.out / "model.amended.toml", discovery.case / "held-out.csv"
        command = [PROGRAMS / "stickslip", "simulate", model, "--inputs", inputs, "--out", out]
        subprocess.run(command, check=True, capture_output=True, text=True)
    return fmpy.read_csv(str(out / "result.csv"))


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_the_amended_fmu_in_fmpy_runs_as_the_native_model(discovery, version):
    fmu = discovery.out / f"ReducedRig.{version}.fmu"
    assert fmpy.supported_platforms(str(fmu))
    description = fmpy.read_model_description(str(fmu))
    starts = {variable.name: variable.start for variable in description.modelVariables}
    for value in discovery.finding["effects"][0]["parameters"].values():
        assert math.isclose(float(starts[value["model_parameter"]]), value["value"], rel_tol=1e-12)
    record = fmpy.read_csv(str(discovery.case / "held-out.csv"))
    result = fmpy.simulate_fmu(
        str(fmu), input=record[["time", "u", "N2"]], stop_time=record["time"][-1], output_interval=0.01, output=["theta_dot"]
    )
    assert len(result) == len(record)
    native = run_natively(discovery)
    assert np.max(np.abs(result["theta_dot"] - native["theta_dot"][: len(record)])) < 1e-9
    free_run = discovery.finding["gap"]["free_run"]
    rmse = math.sqrt(np.mean((result["theta_dot"] - record["theta_dot"]) ** 2))
    # The diagnosis frees N2 from the load cell's noise first; here it is as read, and a free run's phase depends on it.
    assert rmse < 0.5 * free_run["before"]["rmse"]
    assert math.isclose(free_run["after_through_fmu"]["rmse"], free_run["after"]["rmse"], rel_tol=1e-9)


def test_the_report_says_so(discovery):
    page = (discovery.out / "report.html").read_text()
    name = discovery.effect.replace("_", " ")
    assert f"<h1>Missing: {name}</h1>" in page
    for heading in ("Where model and records disagree", "The candidates", "Before and after", "Parameters", "noise floor"):
        assert heading in page
