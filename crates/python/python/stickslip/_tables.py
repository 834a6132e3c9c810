"""Tables of a user as the native module takes them: checked, and named in messages by what the user calls them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy
import pandas
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import InputError

if TYPE_CHECKING:
    import polars

Floats: TypeAlias = NDArray[numpy.float64]
Tabular: TypeAlias = "pandas.DataFrame | polars.DataFrame | Mapping[str, ArrayLike] | NDArray[Any]"
Path: TypeAlias = "str | PathLike[str]"

# Integers that step by this or more are no seconds.
_COUNTS = 1000


def native(table: Tabular, name: str, *, holes: bool, seconds: bool = True) -> _native.Table:
    """A table of any kind for the native module.

    ``holes``: whether values may be missing. ``seconds``: whether time must be in seconds, no unit being given for it.
    """
    columns = list(_columns(table, name))
    labels = [label for label, _ in columns]
    for label in labels:
        if labels.count(label) > 1:
            raise InputError(f"{name}: has {labels.count(label)} columns `{label}`; each name may be there once")
    if "time" not in labels:
        known = ", ".join(labels)
        raise InputError(f"{name}: has no column `time` [s] and no index that could be it; it has {known}")
    times = _times(dict(columns)["time"], name, seconds)
    numbers = [
        (label, _numbers(values, f"{name}: column `{label}`", holes)) for label, values in columns if label != "time"
    ]
    for label, values in numbers:
        if len(values) != len(times):
            raise InputError(f"{name}: column `{label}` has {len(values)} values, `time` has {len(times)}")
    return _native.Table(name, times, numbers)


def frame(columns: list[tuple[str, bytearray]]) -> pandas.DataFrame:
    """Columns of the native module as a table, the first as its index."""
    (index, times), *others = columns
    data = {label: floats(values) for label, values in others}
    return pandas.DataFrame(data, index=pandas.Index(floats(times), name=index))


def read(path: Path) -> pandas.DataFrame:
    """A file of the native module's own as a table with the time as index, the same numbers to the last bit."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        values = numpy.loadtxt(file, delimiter=",", ndmin=2)
    data = {name: values[:, at] for at, name in enumerate(names[1:], 1)}
    return pandas.DataFrame(data, index=pandas.Index(values[:, 0], name=names[0]))


def floats(content: bytearray) -> Floats:
    """A column of the native module as an array."""
    return numpy.frombuffer(content, dtype=numpy.float64)


def _columns(table: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Labels and values, of whatever kind."""
    if isinstance(table, pandas.DataFrame):
        yield from _pandas_columns(table, name)
    elif type(table).__module__.partition(".")[0] == "polars":
        for label in table.columns:
            yield label, _of_polars(table.get_column(label), f"{name}: column `{label}`")
    elif isinstance(table, Mapping):
        for label, values in table.items():
            yield _label(label, name), numpy.asarray(values)
    elif isinstance(table, numpy.ndarray) and table.dtype.names is not None:
        for label in table.dtype.names:
            yield label, table[label]
    else:
        raise InputError(
            f"{name}: is a {type(table).__name__}; a table of pandas or polars, a dict of arrays, a structured array of numpy "
            "or the path of a CSV, Parquet or Excel file is needed"
        )


def _pandas_columns(table: pandas.DataFrame, name: str) -> Iterator[tuple[str, Any]]:
    if isinstance(table.columns, pandas.MultiIndex) or isinstance(table.index, pandas.MultiIndex):
        raise InputError(f"{name}: has names of several levels; take one of them: df[level], or df.droplevel(...)")
    if "time" not in table.columns:
        index = table.index
        if isinstance(index, pandas.RangeIndex) and index.name != "time":
            known = ", ".join(str(label) for label in table.columns)
            raise InputError(
                f"{name}: has no column `time` [s], and its index only counts the rows; it has {known}. With the times in "
                "another column: df.set_index(column)"
            )
        yield "time", index.to_series()
    for at, label in enumerate(table.columns):
        yield _label(label, name), table.iloc[:, at]


def _label(label: Any, name: str) -> str:
    if not isinstance(label, str):
        raise InputError(f"{name}: a column is called {label!r}; names of FMU variables, such as 'theta_dot', are needed")
    return label


def _of_polars(series: polars.Series, where: str) -> Any:
    zone = getattr(series.dtype, "time_zone", None)
    if zone is not None:
        raise _dates(where, f"dates with the time zone {zone}", "(c - c.min()).dt.total_microseconds() / 1e6")
    return series.to_numpy()


def _dates(where: str, what: str, remedy: str) -> InputError:
    return InputError(f"{where} holds {what}; seconds from the start of the record are needed: {remedy}")


def _times(values: Any, name: str, seconds: bool) -> Floats:
    """Times as numbers that increase."""
    where = f"{name}: `time`"
    kind = values.dtype
    if isinstance(kind, pandas.DatetimeTZDtype):
        raise _dates(where, f"dates with the time zone {kind.tz}", "(t - t[0]).total_seconds()")
    if kind.kind == "M":
        raise _dates(where, "dates", "(t - t[0]).total_seconds()")
    if kind.kind == "m":
        values = pandas.to_timedelta(numpy.asarray(values)).total_seconds()
        kind = values.dtype
    times = _numbers(values, where, holes=False)
    if len(times) == 0:
        raise InputError(f"{name}: has no rows")
    steps = numpy.diff(times)
    if seconds and kind.kind in "iu" and len(steps) and abs(float(numpy.median(steps))) >= _COUNTS:
        raise InputError(
            f"{where} holds integers that step by {numpy.median(steps):.0f}: counts of nanoseconds, or the like? Seconds are "
            "needed: time / 1e9"
        )
    wrong = numpy.flatnonzero(steps <= 0)
    if len(wrong):
        row = int(wrong[0]) + 1
        what = "the same as" if steps[row - 1] == 0 else "before"
        remedy = "df[~df.index.duplicated()]" if steps[row - 1] == 0 else "df.sort_index()"
        raise InputError(
            f"{where} is {times[row]:g} s in row {row}, {what} the {times[row - 1]:g} s of the row before; times must "
            f"increase from row to row: {remedy}"
        )
    return times


def _numbers(values: Any, where: str, holes: bool) -> Floats:
    """Values as 64-bit floats; what is missing is NaN."""
    kind = values.dtype
    if getattr(kind, "kind", "O") not in "fiub" or isinstance(kind, pandas.CategoricalDtype):
        raise InputError(f"{where} {_other_kind(values)}")
    if isinstance(values, pandas.Series):
        numbers = values.to_numpy(dtype=numpy.float64, na_value=numpy.nan)
    else:
        numbers = numpy.asarray(values, dtype=numpy.float64)
    if numbers.ndim != 1:
        raise InputError(f"{where} has {numbers.ndim} dimensions; one is needed")
    for is_wrong, what in [(numpy.isinf, "infinite"), (numpy.isnan, "missing (NaN)")]:
        if what != "infinite" and holes:
            continue
        rows = numpy.flatnonzero(is_wrong(numbers))
        if len(rows):
            more = f", as in {len(rows) - 1} more" if len(rows) > 1 else ""
            raise InputError(f"{where} is {what} in row {int(rows[0])}{more}; a finite number is needed")
    return numpy.ascontiguousarray(numbers)


def _other_kind(values: Any) -> str:
    """What a column holds that has no numbers."""
    for row, value in enumerate(values):
        try:
            float(value)
        except (TypeError, ValueError):
            return (
                f"has dtype {values.dtype}: row {row} has {value!r}, a {type(value).__name__}; numbers are needed, or leave the "
                "column out: df.drop(columns=...)"
            )
    return f"has dtype {values.dtype}; numbers are needed: pandas.to_numeric(...)"
