"""Maps: kinds of motion over one or two quantities."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, TypeAlias

import pandas

from . import _native, _tables
from ._jobs import Interrupted, finish_in
from ._native import InputError
from ._rig import Rig
from ._tables import Path

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Span: TypeAlias = "float | tuple[float, float, int]"


class Map:
    """Kinds of motion over one or two quantities.

    Attributes
    ----------
    frame : pandas.DataFrame
        A row for each run: the quantities that vary, ``motion``, ``velocity_minimum``, ``velocity_maximum`` and
        ``half_amplitude`` [rad/s], ``frequency`` [Hz], ``stick_fraction`` and ``switches``, of disc D2 in the last third.
    extrema : pandas.DataFrame
        Local extrema of the velocity [rad/s], for a bifurcation diagram; empty over two quantities.
    axes : list of str
        Names of the quantities that vary.
    failure : str or None
        Why the first of the runs that failed did so; their motion is ``failed``.
    """

    def __init__(self, frame: pandas.DataFrame, extrema: pandas.DataFrame, axes: list[str], failure: str | None) -> None:
        self.frame = frame
        self.extrema = extrema
        self.axes = axes
        self.failure = failure

    def figure(self) -> Figure:
        """Draw the map.

        Returns
        -------
        matplotlib.figure.Figure
            Over two quantities a grid of colours, over one a bifurcation diagram; it is not shown.
        """
        from . import _figures

        return _figures.of_map(self)

    def __repr__(self) -> str:
        counts = self.frame["motion"].value_counts()
        kinds = ", ".join(f"{count} {kind}" for kind, count in counts.items())
        return f"Map over {' and '.join(self.axes)}: {len(self.frame)} runs, {kinds}"

    def _repr_html_(self) -> str:
        return f"<p><b>{escape(repr(self))}</b></p>{self.frame.to_html(max_rows=8)}"


def map(
    rig: Rig,
    *,
    speed_rpm: Span,
    normal_force: Span,
    normal_force_1: Span | None = None,
    vary: Mapping[str, Span] | None = None,
    duration: float = 60.0,
    tolerance: float = 1e-9,
    threads: int | None = None,
    out: Path | None = None,
    progress: bool = True,
) -> Map:
    """Map the kinds of motion over one or two quantities.

    Parameters
    ----------
    rig : Rig
        The rig.
    speed_rpm : float or tuple
        Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig: one value or (from, to, count).
    normal_force : float or tuple
        Normal force N2 on disc D2 [N], likewise.
    normal_force_1 : float or tuple, optional
        Normal force N1 on disc D1 [N] of the full rig, likewise.
    vary : mapping, optional
        Parameters by dotted name, likewise.
    duration : float
        Length of each run [s]; its last third is judged.
    tolerance : float
        Local tolerance of the integrator.
    threads : int, optional
        Threads; all cores if not given.
    out : str or path, optional
        Folder for ``map.csv`` and its pictures. An interrupted map goes on in it with the same call.
    progress : bool
        Whether a progress bar is shown.

    Returns
    -------
    Map
        A row for each run.

    Raises
    ------
    InputError
        What was asked for cannot be; the message says what is right.
    Interrupted
        Ctrl-C; ``partial`` is the map of the rows that are finished.

    Examples
    --------
    >>> import stickslip
    >>> rig = stickslip.Rig.reduced()
    >>> stickslip.map(rig, speed_rpm=(40, 60, 3), normal_force=(0, 50, 2), duration=30)
    Map over speed_rpm and normal_force: 6 runs, 3 steady, 3 stick_slip
    """
    spans = (
        _text(speed_rpm),
        _text(normal_force),
        None if normal_force_1 is None else _text(normal_force_1),
        [(name, _text(span)) for name, span in (vary or {}).items()],
    )

    def begin(folder: FilePath) -> _native.Job:
        return _native.map(rig._native, spans, duration, tolerance, threads, folder)

    ended, kept = finish_in(out, begin, "map", progress)
    made, is_complete = _made(ended.result)
    if ended.is_interrupted or not is_complete:
        raise Interrupted(f"interrupted; {len(made.frame)} finished runs are {kept}", made)
    return made


def _text(span: Span) -> str:
    """A span as the command line has it."""
    if not isinstance(span, tuple):
        return repr(float(span))
    if len(span) != 3 or int(span[2]) != span[2]:
        raise InputError(f"{span} is no range: one value is needed, or (from, to, count) such as (20, 80, 13)")
    return f"{float(span[0])!r}:{float(span[1])!r}:{int(span[2])}"


def _made(result: Any) -> tuple[Map, bool]:
    columns, motion, extrema, is_complete, failure = result
    data = {name: _tables.floats(values) for name, values in columns}
    axes = [name for name, _ in columns[:-6]]
    frame = pandas.DataFrame(data)
    frame["switches"] = frame["switches"].astype("int64")
    frame.insert(len(axes), "motion", motion)
    rows = [
        (frame[axes[-1]].iloc[row], extremum) for row, values in enumerate(extrema) for extremum in _tables.floats(values)
    ]
    return Map(frame, pandas.DataFrame(rows, columns=[axes[-1], "velocity_extremum"]), axes, failure), is_complete
