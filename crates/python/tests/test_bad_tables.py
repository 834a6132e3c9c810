"""Tables that cannot be records or inputs: each is named with its place, what stands there and what would be right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy
import pandas
import polars
import pytest
from conftest import CASE, MODELS

import stickslip

ROWS = 400
RIG = stickslip.Rig.from_toml(CASE / "model.toml")

Change = Callable[[pandas.DataFrame], object]


def duplicated(record: pandas.DataFrame) -> pandas.DataFrame:
    return record.set_axis([*record.index[:7], record.index[6], *record.index[8:]])


def backward(record: pandas.DataFrame) -> pandas.DataFrame:
    return record.iloc[::-1]


def with_value(column: str, row: int, value: object) -> Change:
    def change(record: pandas.DataFrame) -> object:
        changed: Any = record.astype({column: object}) if isinstance(value, str) else record.copy()
        changed.iloc[row, changed.columns.get_loc(column)] = value
        return changed

    return change


def with_index(make: Callable[[Any], Any]) -> Change:
    return lambda record: record.set_axis(make(record.index))


def dates(zone: str | None) -> Change:
    return with_index(lambda index: pandas.Timestamp("2026-03-29", tz=zone) + pandas.to_timedelta(index, unit="s"))


BAD: dict[str, tuple[Change, list[str]]] = {
    "no rows": (lambda record: record.iloc[:0], ["records[0]: has no rows"]),
    "object column": (
        with_value("theta", 3, "1,5"),
        ["records[0]: column `theta` has dtype object", "row 3 has '1,5', a str", "numbers are needed"],
    ),
    "numbers as text": (
        lambda record: record.astype({"u": str}),
        ["records[0]: column `u` has dtype", "pandas.to_numeric"],
    ),
    "categories": (
        lambda record: record.assign(kind=pandas.Categorical(["a"] * len(record))),
        ["column `kind` has dtype category", "row 0 has 'a'", "leave the column out"],
    ),
    "complex numbers": (
        lambda record: record.assign(theta=record["theta"] * 1j),
        ["column `theta` has dtype complex128", "numbers are needed"],
    ),
    "dates": (dates(None), ["records[0]: `time` holds dates; seconds", "total_seconds()"]),
    "dates with a time zone": (dates("Europe/Berlin"), ["`time` holds dates with the time zone Europe/Berlin", "total_seconds()"]),
    "nanoseconds": (
        with_index(lambda index: (index.to_numpy() * 1e9).round().astype("int64")),
        ["`time` holds integers that step by 10000000", "nanoseconds", "time / 1e9"],
    ),
    "duplicated index": (
        duplicated,
        ["`time` is 0.06 s in row 7, the same as the 0.06 s of the row before", "~df.index.duplicated()"],
    ),
    "index backward": (backward, ["in row 1, before the", "df.sort_index()"]),
    "index that counts": (
        lambda record: record.reset_index(drop=True),
        ["records[0]: has no column `time` [s], and its index only counts the rows; it has u, N2", "df.set_index(column)"],
    ),
    "missing time": (
        with_index(lambda index: [numpy.nan, *index[1:]]),
        ["records[0]: `time` is missing (NaN) in row 0"],
    ),
    "infinite reading": (with_value("theta", 5, numpy.inf), ["column `theta` is infinite in row 5"]),
    "a name twice": (
        lambda record: pandas.concat([record, record[["theta"]]], axis=1),
        ["has 2 columns `theta`"],
    ),
    "names of two levels": (
        lambda record: pandas.concat({"bench": record}, axis=1),
        ["records[0]: has names of several levels", "droplevel"],
    ),
    "names that are numbers": (lambda record: record.set_axis(range(record.shape[1]), axis=1), ["a column is called 0"]),
    "a list": (lambda record: record.to_numpy().tolist(), ["records[0]: is a list; a table of pandas or polars"]),
    "an array without names": (lambda record: record.to_numpy(), ["records[0]: is a ndarray; a table"]),
    "columns of another length": (
        lambda record: {"time": record.index, "u": record["u"][:-1]},
        [f"column `u` has {ROWS - 1} values, `time` has {ROWS}"],
    ),
    "no inputs": (lambda record: record.drop(columns="N2"), ["records[0]: has no column `N2`"]),
    "nothing measured": (lambda record: record[["u", "N2"]], ["records[0]: has no column of the motion"]),
    "velocity in rpm": (
        lambda record: record.assign(theta_dot=record["theta_dot"] * 30 / numpy.pi),
        ["records[0]", "rpm"],
    ),
    "polars dates": (
        lambda record: polars.DataFrame(
            {"time": [pandas.Timestamp("2026-03-29", tz="UTC")], "u": [1.0], "N2": [1.0], "theta": [0.0]}
        ),
        ["holds dates with the time zone UTC", "total_microseconds"],
    ),
    "polars text": (
        lambda record: polars.DataFrame({"time": [0.0, 1.0], "u": ["a", "b"]}),
        ["column `u` has dtype object", "row 0 has 'a'"],
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_table_that_is_no_record(name: str, records: dict[str, pandas.DataFrame], refused: Callable[..., str]) -> None:
    change, expected = BAD[name]
    record = records["run-a"].iloc[:ROWS]
    message = refused(stickslip.Case, RIG, [change(record)], held_out=records["held-out"])
    for part in expected:
        assert part in message, message


def test_the_held_out_record_and_named_records_are_called_so(
    records: dict[str, pandas.DataFrame], refused: Callable[..., str]
) -> None:
    good = records["run-a"]
    assert "held_out: has no rows" in refused(stickslip.Case, RIG, [good], held_out=good.iloc[:0])
    assert "monday: has no rows" in refused(stickslip.Case, RIG, {"monday": good.iloc[:0]}, held_out=good)
    assert "same measurement" in refused(stickslip.Case, RIG, [good], held_out=good)
    assert "a list of tables or paths is needed" in refused(stickslip.Case, RIG, good)
    assert "there is none" in refused(stickslip.Case, RIG, [])


def test_missing_readings_are_holes(records: dict[str, pandas.DataFrame]) -> None:
    holes: Any = records["run-a"].copy()
    holes.iloc[100:104, holes.columns.get_loc("theta")] = numpy.nan
    nullable = holes.convert_dtypes()
    for record in (holes, nullable, polars.DataFrame(holes.reset_index())):
        case = stickslip.Case(RIG, [record, records["run-b"]], held_out=records["held-out"])
        assert any("records[0]" in note for note in case.notes), case.notes


def test_inputs_of_a_run_have_no_holes(refused: Callable[..., str]) -> None:
    inputs = pandas.DataFrame({"u": [3.0, numpy.nan], "N2": [20.0, 20.0]}, index=[0.0, 1.0])
    assert "inputs: column `u` is missing (NaN) in row 1" in refused(RIG.simulate, inputs=inputs)


def test_a_record_of_another_rig(records: dict[str, pandas.DataFrame], refused: Callable[..., str]) -> None:
    """A record of the full rig, and one of a rig whose gears are others."""
    full = stickslip.Rig.from_toml(MODELS / "full-rig.toml")
    assert "records[0]: has no column `N1`" in refused(stickslip.Case, full, [records["run-a"]])
    geared = RIG.with_(gearbox_ratio=40.0)
    message = refused(stickslip.Case, geared, [records["run-a"]], held_out=records["held-out"])
    assert "records[0]" in message and "this motor turns its gearbox at most" in message, message


def test_columns_that_are_none(records: dict[str, pandas.DataFrame], refused: Callable[..., str]) -> None:
    good = [records["run-a"], records["run-b"]]

    def message(columns: object) -> str:
        return refused(stickslip.Case, RIG, good, columns=columns)

    assert "`thet` is no variable of a record (is `theta` meant?)" in message({"thet": "deg"})
    assert '"parsec" cannot be converted' in message({"theta": "parsec"})
    assert "has no column `angle`" in message({"theta": ("angle", "deg")})
    assert "factor = 0" in message({"theta": {"column": "theta", "factor": 0.0}})


def test_sensors_that_are_none(records: dict[str, pandas.DataFrame], refused: Callable[..., str]) -> None:
    good = [records["run-a"], records["run-b"]]
    assert "disc_encoder_stp" in refused(stickslip.Case, RIG, good, sensors={"disc_encoder_stp": 0.006})
    assert "cannot be read" in refused(stickslip.Case, RIG, good, sensors="absent.toml")
    assert "unbalence" in refused(stickslip.Case, RIG, good, without=["unbalence"])


def test_times_in_milliseconds_are_told_by_their_unit(records: dict[str, pandas.DataFrame]) -> None:
    def in_ms(record: pandas.DataFrame) -> pandas.DataFrame:
        return record.set_axis((record.index.to_numpy() * 1000).round().astype("int64"))

    changed = [in_ms(records[name]) for name in ("run-a", "run-b", "held-out")]
    case = stickslip.Case(RIG, changed[:2], held_out=changed[2], columns={"time": "ms"})
    assert any("converted from ms to s" in note for note in case.notes), case.notes
