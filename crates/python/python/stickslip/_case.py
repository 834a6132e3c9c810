"""Cases: a model, records to learn from, a record to judge on."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from os import PathLike
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, TypeAlias

from . import _native
from ._finding import Finding
from ._jobs import Interrupted, finish, need_engine
from ._native import InputError
from ._rig import Rig
from ._tables import Path, Tabular, native

if TYPE_CHECKING:
    from typing import Self

Record: TypeAlias = "Tabular | Path"
Column: TypeAlias = "str | tuple[str, str] | Mapping[str, str | float]"


class Case:
    """A model that is believed, records to learn from, and a record to judge on.

    Parameters
    ----------
    model : Rig or path
        The model. A path may also be that of a small plant: a drive, a pendulum, a contact, a balance, or the
        ports file of an FMU, whose ``[plant]`` names it.
    records : sequence or mapping of tables or paths
        Records to learn from, each with times [s] as index or as column ``time``, the inputs ``u`` [V] and ``N2`` [N], and some
        of ``theta``, ``theta3`` [rad], ``theta_dot``, ``theta3_dot`` [rad/s] and ``i`` [A], of shape (rows,) each; of the full
        rig also ``N1`` [N] and, where measured, ``theta1`` and ``theta1_dot``. A missing value is a hole. Keys of a mapping
        name the records in messages and in the amended model. A path is that of a CSV, Parquet or Excel file; it may end in
        ``#SHEET`` and in ``@FROM:TO`` [s].
    held_out : table or path, optional
        Record to judge on, never fitted to. Without it the last record is held out, or the last quarter of a single one.
    columns : mapping, optional
        Columns by the variable that they are, where their names or units are others: a unit (``{"theta_dot": "rpm"}``), a name
        and a unit (``{"theta_dot": ("disc speed", "rpm")}``), or ``{"column": …, "unit": …, "factor": …}``. They replace the
        model's ``[columns]``.
    sensors : mapping or path, optional
        Steps and noise of the instruments, as in a ``sensors.toml``; without it they are estimated from the records.
    effects : iterable of path
        Files with effects of your own, sections ``[[effect]]``, that are tried beside those of the catalogue.
    without : iterable of str
        Effects that are left out of the catalogue.
    name : str, optional
        What messages and the report call the case; the model's name if not given.

    Attributes
    ----------
    notes : list of str
        What has to be said about the records.

    Raises
    ------
    InputError
        A record, the model or the sensors cannot be used; the message says what is right.

    Examples
    --------
    >>> import stickslip
    >>> rig = stickslip.Rig.reduced()
    >>> measured = rig.with_(unbalance={"torque": 0.04, "phase": 0.0})
    >>> records = [measured.simulate(speed_rpm=speed, normal_force=20, stop=10).frame for speed in (40, 50, 60)]
    >>> case = stickslip.Case(rig, records[:2], held_out=records[2])
    >>> case
    Case 'reduced rig': 2 records
    """

    def __init__(
        self,
        model: Rig | Path,
        records: Sequence[Record] | Mapping[str, Record],
        held_out: Record | None = None,
        *,
        columns: Mapping[str, Column] | None = None,
        sensors: Mapping[str, float] | Path | None = None,
        effects: Iterable[Path] = (),
        without: Iterable[str] = (),
        name: str | None = None,
    ) -> None:
        if isinstance(model, Rig):
            model_name, text = model.name, model.to_toml()
        else:
            model_name, text = str(model), _text_of(model)
        if columns:
            text = f"{_without_columns(text)}\n{_columns_table(columns)}"
        given = _named(records)
        seconds = "time" not in (columns or {})
        self._start(
            _native.Case(
                name if name is not None else FilePath(model_name).name,
                (model_name, text),
                [_record(record, label, seconds) for label, record in given.items()],
                None if held_out is None else _record(held_out, "held_out", seconds),
                _sensors(sensors),
                [(str(path), _text_of(path)) for path in effects],
                list(without),
            ),
            len(given),
        )

    @classmethod
    def from_directory(cls, directory: Path, *, without: Iterable[str] = ()) -> Self:
        """Read the case in a directory, as the program ``stickslip diagnose`` does.

        Parameters
        ----------
        directory : str or path
            Folder with ``model.toml``, ``run-*.csv`` (or ``.parquet``, ``.xlsx``) and, if need be, ``held-out.csv``,
            ``sensors.toml`` and ``effects/``.
        without : iterable of str
            Effects that are left out of the catalogue.

        Returns
        -------
        Case
            The case.
        """
        case = cls.__new__(cls)
        count = len([path for path in FilePath(directory).glob("run-*") if path.suffix in (".csv", ".parquet", ".xlsx")])
        case._start(_native.Case.in_directory(directory, list(without)), count)
        return case

    def _start(self, native_case: _native.Case, count: int) -> None:
        need_engine()
        self._native = native_case
        self._count = count
        ended = finish(native_case.check(), "records", "record", progress=False)
        if ended.is_interrupted:
            raise Interrupted("interrupted while the records were checked")
        self.notes: list[str] = ended.result

    @property
    def name(self) -> str:
        """What messages and the report call it."""
        return self._native.name

    @property
    def model(self) -> Rig:
        """The model that is believed."""
        return Rig.from_text(self._native.model_text, self._native.model_name)

    def diagnose(self, *, out: Path | None = None, library: Path | None = None, progress: bool = True) -> Finding:
        """Name the effect that the model lacks, add it, and show on the held-out record that the gap is closed.

        Parameters
        ----------
        out : str or path, optional
            Folder for ``finding.json``, the amended model with its FMUs, and the report. Without it they are kept as long as the
            finding is; :meth:`Finding.save` copies them.
        library : str or path, optional
            The library to pack into the FMUs; without it that of the package.
        progress : bool
            Whether a progress bar is shown.

        Returns
        -------
        Finding
            What was found.

        Raises
        ------
        Interrupted
            Ctrl-C; ``partial`` is the finding if there was one already, without comparison and report.
        """
        place = tempfile.TemporaryDirectory(prefix="stickslip-") if out is None else None
        folder = FilePath(place.name if place is not None else str(out))
        need_engine()
        ended = finish(self._native.diagnose(folder, library), "diagnose", "step", progress)
        if ended.result is None:
            kept, sentence = self._native.left(folder)
            partial = Finding(folder, None, str(self), [], place) if "finding.json" in kept else None
            raise Interrupted(sentence if out is not None else "interrupted; what is finished is `partial`", partial)
        is_settled, screen, stretches = ended.result
        return Finding(folder, is_settled, screen, stretches or [], place)

    def __repr__(self) -> str:
        return f"Case {self.name!r}: {self._count} records"

    def _repr_html_(self) -> str:
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.notes)
        return f"<p><b>{escape(repr(self))}</b></p><ul>{notes}</ul>"


def _named(records: Sequence[Record] | Mapping[str, Record]) -> dict[str, Record]:
    if isinstance(records, Mapping):
        return dict(records)
    if not isinstance(records, (list, tuple)):
        raise InputError(f"records: is a {type(records).__name__}; a list of tables or paths is needed: [table]")
    return {f"records[{at}]": record for at, record in enumerate(records)}


def _record(record: Record, name: str, seconds: bool) -> _native.Table | Path:
    return record if isinstance(record, (str, PathLike)) else native(record, name, holes=True, seconds=seconds)


def _text_of(path: Path) -> str:
    try:
        return FilePath(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _sensors(sensors: Mapping[str, float] | Path | None) -> tuple[str, str] | None:
    if sensors is None:
        return None
    if isinstance(sensors, Mapping):
        return "sensors", "".join(f"{key} = {float(value)!r}\n" for key, value in sensors.items())
    return str(sensors), _text_of(sensors)


def _without_columns(text: str) -> str:
    return _native.split_columns(text)[1]


def _columns_table(columns: Mapping[str, Column]) -> str:
    """The table ``[columns]`` of a model file."""
    lines = ["[columns]"]
    for variable, given in columns.items():
        if isinstance(given, str):
            entry: dict[str, str | float] = {"column": variable, "unit": given}
        elif isinstance(given, Mapping):
            entry = {"column": variable, **given}
        else:
            column, unit = given
            entry = {"column": column, "unit": unit}
        words = ", ".join(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in entry.items())
        lines.append(f"{json.dumps(variable)} = {{ {words} }}")
    return "\n".join(lines) + "\n"
