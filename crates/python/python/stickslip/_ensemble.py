"""Ensembles: rigs whose parameters are drawn from their uncertainties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import pandas

from . import _native, _tables
from ._jobs import Interrupted, finish_in
from ._map import Span, _text
from ._rig import Rig
from ._tables import Path

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Ensemble:
    """Rigs whose parameters are drawn from their uncertainties, run at every speed and normal force.

    Attributes
    ----------
    frame : pandas.DataFrame
        A row for each speed and normal force: how many ``runs``, how many of them ``failed``, the share of each kind of
        motion, the 95 % interval of that of stick-slip, and 5, 50 and 95 % quantiles of each measure.
    runs : pandas.DataFrame
        A row for each run, with the columns of a map and the number of its rig.
    rigs : pandas.DataFrame
        The parameters of each rig that were drawn; its number is the index.
    failure : str or None
        Why the first of the runs that failed did so; they count for no probability.
    """

    def __init__(self, frame: pandas.DataFrame, runs: pandas.DataFrame, rigs: pandas.DataFrame, failure: str | None) -> None:
        self.frame = frame
        self.runs = runs
        self.rigs = rigs
        self.failure = failure

    def figure(self) -> Figure:
        """Draw the probability of stick-slip.

        Returns
        -------
        matplotlib.figure.Figure
            Over speed and normal force a grid of colours, over one of them a curve with its interval, at one place a
            histogram of the half amplitude; it is not shown.
        """
        from . import _figures

        return _figures.of_ensemble(self)

    def __repr__(self) -> str:
        share = (self.runs["motion"] == "stick_slip").mean() if len(self.runs) else float("nan")
        return f"Ensemble of {len(self.rigs)} rigs at {len(self.frame)} places, {100 * share:.1f} % stick_slip"

    def _repr_html_(self) -> str:
        return f"<p><b>{escape(repr(self))}</b></p>{self.frame.to_html(max_rows=8)}"


def ensemble(
    rig: Rig,
    *,
    speed_rpm: Span,
    normal_force: Span,
    runs: int,
    seed: int,
    normal_force_1: float | None = None,
    draw: Sequence[str] = (),
    uncertain: Mapping[str, float] | None = None,
    duration: float = 60.0,
    tolerance: float = 1e-9,
    threads: int | None = None,
    out: Path | None = None,
    progress: bool = True,
) -> Ensemble:
    """Run rigs whose parameters are drawn from their uncertainties.

    Parameters
    ----------
    rig : Rig
        The nominal rig, whose model states the uncertainties of its numbers.
    speed_rpm : float or tuple
        Speed at the gearbox output [rpm] that the voltage would give the undisturbed nominal rig: one value or
        (from, to, count).
    normal_force : float or tuple
        Normal force N2 on disc D2 [N], likewise.
    runs : int
        Number of rigs that are drawn; each runs at every speed and normal force.
    seed : int
        Number of the random draw: the same seed gives the same rigs.
    normal_force_1 : float, optional
        Normal force N1 on disc D1 [N] of the full rig.
    draw : sequence of str
        Parameters to draw, by dotted name; without them all whose ``relative_uncertainty`` the model states.
    uncertain : mapping, optional
        Relative standard deviations by dotted name, in place of what the model states; 0 holds a parameter.
    duration : float
        Length of each run [s]; its last third is judged.
    tolerance : float
        Local tolerance of the integrator.
    threads : int, optional
        Threads; all cores if not given.
    out : str or path, optional
        Folder for ``ensemble.csv``, ``runs.csv``, ``rigs.csv`` and the picture. An interrupted ensemble goes on in it with
        the same call.
    progress : bool
        Whether a progress bar is shown.

    Returns
    -------
    Ensemble
        Probabilities and bands, runs and rigs.

    Raises
    ------
    InputError
        What was asked for cannot be; the message says what is right.
    Interrupted
        Ctrl-C; ``partial`` is the ensemble of the rigs whose runs are finished.

    Examples
    --------
    >>> import stickslip
    >>> rig = stickslip.Rig.reduced()
    >>> stickslip.ensemble(rig, speed_rpm=55, normal_force=(5, 50, 2), runs=10, seed=1, duration=30)
    Ensemble of 10 rigs at 2 places, 50.0 % stick_slip
    """
    spans = (_text(speed_rpm), _text(normal_force), normal_force_1)
    drawn = (list(draw), list((uncertain or {}).items()))

    def begin(folder: FilePath) -> _native.Job:
        return _native.ensemble(rig._native, spans, (runs, seed), drawn, (duration, tolerance), threads, folder)

    ended, kept = finish_in(out, begin, "ensemble", progress)
    made, is_complete = _made(ended.result)
    if ended.is_interrupted or not is_complete:
        raise Interrupted(f"interrupted; {len(made.rigs)} finished rigs are {kept}", made)
    return made


def _made(result: Any) -> tuple[Ensemble, bool]:
    tables, motion, is_complete, failure = result
    frame, runs, rigs = (
        pandas.DataFrame({name: _tables.floats(values) for name, values in columns}) for columns in tables
    )
    frame = frame.astype({"runs": "int64", "failed": "int64"})
    runs = runs.astype({"rig": "int64", "switches": "int64"})
    runs.insert(3, "motion", motion)
    return Ensemble(frame, runs, rigs.astype({"rig": "int64"}).set_index("rig"), failure), is_complete
