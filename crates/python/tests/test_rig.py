"""Rigs and runs."""

from __future__ import annotations

import pathlib
import pickle
from collections.abc import Callable

import numpy
import pandas
import polars
import pytest
from conftest import MODELS

import stickslip


def test_names_may_be_written_with_dots_or_underscores() -> None:
    rig = stickslip.Rig.reduced()
    for changed in (
        rig.with_({"contact.mu_s": 0.25}),
        rig.with_(contact_mu_s=0.25),
        rig.with_(contact__mu_s=0.25),
        stickslip.Rig.reduced(contact_mu_s=0.25),
    ):
        assert changed["contact.mu_s"] == 0.25
    assert rig["contact.mu_s"] == 0.2


def test_effects_go_on_and_off() -> None:
    rig = stickslip.Rig.reduced(unbalance={"torque": 0.04, "phase": 0.0}, unbalance_torque=0.05)
    assert (rig.effects, rig["unbalance.torque"]) == (["unbalance"], 0.05)
    assert rig.with_(unbalance={"phase": 1.0})["unbalance.torque"] == 0.05
    assert rig.with_(unbalance=None).effects == []


def test_a_changed_number_keeps_what_is_known_of_it_and_loses_its_source() -> None:
    changed = stickslip.Rig.reduced(disc_inertia=0.015)
    assert changed.parameters.loc["disc.inertia", "relative_uncertainty"] == 0.006
    line = next(line for line in changed.to_toml().splitlines() if line.startswith("inertia = { value = 0.015"))
    assert "Table 4.1" not in line


def test_a_rig_survives_its_text_and_a_pickle() -> None:
    for rig in (stickslip.Rig.reduced(), stickslip.Rig.full(unbalance1={"torque": 1.0 / 3.0, "phase": 0.1})):
        assert stickslip.Rig.from_text(rig.to_toml()) == rig
        assert pickle.loads(pickle.dumps(rig)) == rig


def test_columns_of_a_model_file_stay_with_the_rig() -> None:
    text = (MODELS / "reduced-rig.toml").read_text()
    columns = '\n[columns]\ntheta_dot = { column = "n", unit = "rpm" }\n'
    rig = stickslip.Rig.from_text(text + columns)
    assert columns.strip() in rig.with_(contact_mu_s=0.25).to_toml()
    assert rig.simulate(speed_rpm=55, normal_force=50, stop=1).frame.equals(
        stickslip.Rig.from_text(text).simulate(speed_rpm=55, normal_force=50, stop=1).frame
    )


def test_what_is_wrong_with_a_rig_is_named_with_what_is_right(refused: Callable[..., str], tmp_path: pathlib.Path) -> None:
    rig = stickslip.Rig.reduced()
    assert "`contact.mu_s` meant" in refused(rig.with_, contact_mu_ss=0.2)
    assert "mu_c" in refused(rig.with_, contact_mu_s=0.01)
    assert "`unbalance` meant" in refused(rig.with_, unbalence={"torque": 1.0})
    assert "`phase` is missing" in refused(rig.with_, unbalance={"torque": 1.0})
    assert "it has torque, phase" in refused(rig.with_, unbalance={"torque": 1.0, "phases": 0.0})
    assert "no effect unbalance" in refused(rig.with_, unbalance=None)
    assert "cannot have an effect `unbalance1`" in refused(rig.with_, unbalance1={"torque": 1.0, "phase": 0.0})
    assert "No such file" in refused(stickslip.Rig.from_toml, tmp_path / "absent.toml")
    assert "is a controller" in refused(stickslip.Rig.from_toml, MODELS / "soft-torque.toml")
    assert "model.toml: section [contact] is missing" in refused(stickslip.Rig.from_text, "[disc]\ninertia = 1.0\n", "model.toml")
    assert "linux64" in refused(rig.build_fmu, tmp_path, platforms=["win32"])
    assert "2 or 3" in refused(rig.build_fmu, tmp_path, fmi=1)
    with pytest.raises(KeyError, match="contact.mu_s"):
        rig["contact.mu"]


def test_tables_of_every_kind_drive_the_same_run() -> None:
    rig = stickslip.Rig.reduced()
    columns = {"time": [0.0, 1.0, 1.5], "u": [3.0, 2.0, 2.5], "N2": [20.0, 20.0, 30.0]}
    frame = pandas.DataFrame(columns)
    structured = numpy.array(list(zip(*columns.values(), strict=True)), dtype=[(name, "f8") for name in columns])
    runs = [
        rig.simulate(inputs=inputs, stop=4).frame
        for inputs in (
            frame,
            frame.set_index("time"),
            polars.DataFrame(columns),
            columns,
            structured,
        )
    ]
    assert all(run.equals(runs[0]) for run in runs[1:])
    assert runs[0].index[-1] == 4.0 and set(runs[0]["u"]) == {3.0, 2.0, 2.5}


def test_times_as_spans_are_seconds() -> None:
    rig = stickslip.Rig.reduced()
    inputs = pandas.DataFrame({"u": [3.0, 2.0], "N2": [20.0, 20.0]})
    spans = inputs.set_index(pandas.to_timedelta([0, 500], unit="ms"))
    assert rig.simulate(inputs=spans, stop=1).frame.equals(rig.simulate(inputs=inputs.set_axis([0.0, 0.5]), stop=1).frame)


def test_a_run_comes_out_as_every_kind_of_table() -> None:
    run = stickslip.Rig.reduced().simulate(speed_rpm=55, normal_force=50, stop=1)
    other = run.to_polars()
    assert other.columns == ["time", *run.frame]
    assert (other["theta"].to_numpy() == run["theta"].to_numpy()).all()
    assert (run.to_numpy()["theta"] == run["theta"].to_numpy()).all()


def test_chosen_variables_and_states_at_the_start() -> None:
    rig = stickslip.Rig.reduced()
    start = {"theta": 0.1, "theta_dot": 5.0, "theta3": 0.2, "theta3_dot": 5.5}
    run = rig.simulate(speed_rpm=55, normal_force=50, stop=0.1, step=0.001, start=start, variables=["theta", "theta_dot", "der(theta_dot)"])
    assert list(run.frame) == ["theta", "theta_dot", "der(theta_dot)"]
    assert (run.frame.iloc[0, :2] == [0.1, 5.0]).all()
    slope = numpy.gradient(run["theta_dot"], run.frame.index)[5:-5]
    assert numpy.abs(slope - run["der(theta_dot)"].to_numpy()[5:-5]).max() < 0.05 * numpy.abs(slope).max()


def test_derivatives_are_those_of_neighbouring_runs() -> None:
    rig = stickslip.Rig.reduced()
    names = ["contact.mu_s", "shaft.stiffness"]
    run = rig.simulate(speed_rpm=55, normal_force=50, stop=5, derivatives=names)
    assert run.derivatives is not None and run.derivatives_end is None
    inputs = {"time": [0.0], "u": [rig.voltage_for(55)], "N2": [50.0]}
    for name in names:
        off = 1e-6 * rig[name]
        above, below = (rig.with_({name: rig[name] + sign * off}).simulate(inputs=inputs, stop=5) for sign in (1, -1))
        for state in ("theta", "i"):
            expected = (above[state] - below[state]) / (2 * off)
            found = run.derivatives[state, name]
            assert numpy.abs(found - expected).max() < 1e-3 * numpy.abs(expected).max(), (state, name)


def test_events_are_when_the_disc_begins_and_ends_to_stick() -> None:
    run = stickslip.Rig.reduced().simulate(speed_rpm=55, normal_force=50, stop=20, step=0.001)
    sticks = run.events[run.events["event"] == "disc D2 sticks"]["time"].to_numpy()
    changes = run.frame.index[1:][numpy.diff(run["stuck"]) > 0].to_numpy()
    assert len(sticks) == len(changes) > 5
    assert (changes >= sticks).all() and (changes - sticks <= 0.001 + 1e-9).all()


def test_what_a_run_cannot_be_is_refused_with_what_is_right(refused: Callable[..., str]) -> None:
    simulate = stickslip.Rig.reduced().simulate
    held = {"speed_rpm": 55, "normal_force": 50}
    assert "inputs, or speed_rpm with normal_force" in refused(simulate)
    assert "cannot stand beside inputs" in refused(simulate, inputs={"time": [0.0]}, speed_rpm=55)
    assert "normal_force = -1" in refused(simulate, speed_rpm=55, normal_force=-1)
    assert "normal_force_1: this rig has no disc D1" in refused(simulate, **held, normal_force_1=1)
    assert "stop = 0" in refused(simulate, **held, stop=0)
    assert "step 0:" in refused(simulate, **held, step=0)
    assert "`thet`" in refused(simulate, **held, start={"thet": 1.0})
    assert "did you mean `theta_dot`" in refused(simulate, **held, variables=["theta_dott"])
    assert "did you mean `contact.mu_s`" in refused(simulate, **held, derivatives=["contact.mu_ss"])
    assert "no column `N2`" in refused(simulate, inputs={"time": [0.0], "u": [1.0]})
    assert "did you mean" in refused(simulate, inputs={"time": [0.0], "u": [1.0], "n2": [1.0]})
    assert "is not a parameter" not in refused(simulate, inputs="absent.csv")


def test_figures_are_returned_and_displayed_by_notebooks() -> None:
    rig = stickslip.Rig.reduced()
    run = rig.simulate(speed_rpm=55, normal_force=50, stop=2)
    for figure in (
        run.figure(),
        stickslip.map(rig, speed_rpm=(40, 60, 3), normal_force=(0, 50, 2), duration=10).figure(),
        stickslip.map(rig, speed_rpm=(40, 60, 3), normal_force=50, duration=10).figure(),
    ):
        assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]
        assert figure.axes[0].get_xlabel() or figure.axes[-1].get_xlabel()
    for shown in (rig, run):
        assert "<table" in shown._repr_html_()


def test_what_an_ensemble_cannot_be_is_refused_with_what_is_right(refused: Callable[..., str]) -> None:
    rig = stickslip.Rig.reduced()

    def message(**words: object) -> str:
        return refused(stickslip.ensemble, rig, **{"speed_rpm": 55, "normal_force": 50, "runs": 5, "seed": 1, **words})

    assert "runs 0" in message(runs=0)
    assert "did you mean `contact.mu_s`" in message(draw=["contact.mu_ss"])
    assert "no relative_uncertainty of gearbox.ratio" in message(draw=["gearbox.ratio"])
    assert "below 1" in message(uncertain={"contact.mu_s": 2.0})


def test_what_a_map_cannot_be_is_refused_with_what_is_right(refused: Callable[..., str]) -> None:
    rig = stickslip.Rig.reduced()

    def message(**spans: object) -> str:
        return refused(stickslip.map, rig, **{"speed_rpm": (20, 60, 3), "normal_force": 50, **spans})

    assert "(from, to, count)" in message(normal_force=(0, 50))
    assert "a range needs two" in message(normal_force=(50, 50, 3))
    assert "normal_force: `1` is not a number of values" in message(normal_force=(0, 50, 1))
    assert "a force of 0 N or more" in message(normal_force=(-1, 50, 3))
    assert "0 ranges were given" in message(speed_rpm=55)
    assert "did you mean `contact.mu_s`" in message(vary={"contact.mu_ss": (0.1, 0.2, 3)})
    assert "tolerance" in message(tolerance=1.0)
    assert "no disc D1" in message(normal_force_1=1)
    assert "normal_force_1 is needed too" in refused(stickslip.map, stickslip.Rig.full(), speed_rpm=(20, 60, 3), normal_force=50)
