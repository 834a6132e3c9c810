"""Runs: columns over time, what happened, and derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy
import pandas
from numpy.typing import NDArray

from . import _tables

if TYPE_CHECKING:
    import polars
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Summary:
    """What a run came to, of disc D2.

    Attributes
    ----------
    motion : str
        Kind of motion: ``stick_slip``, ``sticking``, ``oscillation``, ``steady`` or ``no_motion``.
    frequency : float or None
        Frequency of its limit cycle [Hz], if there is one.
    velocity : tuple of float
        Lowest and highest velocity [rad/s].
    stick_fraction : float
        Share of the time in which it sticks, 0 … 1.
    judged : tuple of float
        The times [s], the last third of the run, between which all of this is meant.
    switches : int
        Switches between sticking and slipping over the whole run, of all contacts.
    """

    motion: str
    frequency: float | None
    velocity: tuple[float, float]
    stick_fraction: float
    judged: tuple[float, float]
    switches: int


class Run:
    """A run of a rig.

    ``run["theta_dot"]`` is a column of :attr:`frame`.

    Attributes
    ----------
    title : str
        The rig and what drove it.
    frame : pandas.DataFrame
        FMU variables [SI units] over time [s], shape (rows, variables). A row holds the inputs in force from its time on.
    events : pandas.DataFrame
        When [s] which contact began to stick or broke away: columns ``time`` and ``event``.
    derivatives : pandas.DataFrame or None
        Derivatives of the states with respect to parameters over time, in the state's unit over the parameter's; columns
        are pairs of state and parameter, shape (rows, states × parameters).
    derivatives_end : float or None
        Time [s] from which on the derivatives do not exist: the motion grazed a switch there.
    summary : Summary or None
        What the run came to; None where it was interrupted or has no column ``theta_dot``.

    Examples
    --------
    >>> import stickslip
    >>> run = stickslip.Rig.reduced().simulate(speed_rpm=55, normal_force=50, stop=20)
    >>> round(float(run["theta_dot"].max()), 1)
    12.7
    >>> run.events.iloc[0].event
    'the motor breaks away'
    """

    def __init__(
        self,
        title: str,
        frame: pandas.DataFrame,
        events: pandas.DataFrame,
        derivatives: pandas.DataFrame | None,
        derivatives_end: float | None,
        summary: Summary | None,
    ) -> None:
        self.title = title
        self.frame = frame
        self.events = events
        self.derivatives = derivatives
        self.derivatives_end = derivatives_end
        self.summary = summary

    @classmethod
    def _of(cls, rig: str, result: Any) -> Run:
        description, columns, events, summary, derived = result
        frame = _tables.frame(columns)
        derivatives, end = None, None
        if derived is not None:
            pairs, values, interrupted = derived
            derivatives = pandas.DataFrame(
                {pair: _tables.floats(column) for pair, column in zip(pairs, values, strict=True)}, index=frame.index
            )
            derivatives.columns = pandas.MultiIndex.from_tuples(pairs, names=["state", "parameter"])
            end = None if interrupted is None else float(frame.index[interrupted])
        return cls(
            f"{rig}: {description}",
            frame,
            pandas.DataFrame(events, columns=["time", "event"]),
            derivatives,
            end,
            None if summary is None else Summary(*summary),
        )

    def __getitem__(self, name: str) -> pandas.Series:
        return self.frame[name]

    def to_polars(self) -> polars.DataFrame:
        """Make a table of polars.

        Returns
        -------
        polars.DataFrame
            The columns of :attr:`frame`, ``time`` first.
        """
        import polars

        return polars.DataFrame({"time": self.frame.index.to_numpy(), **{name: self.frame[name].to_numpy() for name in self.frame}})

    def to_numpy(self) -> NDArray[numpy.void]:
        """Make a structured array of NumPy.

        Returns
        -------
        numpy.ndarray
            Shape (rows,), with the fields ``time`` and those of :attr:`frame`.
        """
        return self.frame.to_records()

    def figure(self) -> Figure:
        """Draw velocities and friction torque.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; it is not shown.
        """
        from . import _figures

        return _figures.of_run(self)

    def __repr__(self) -> str:
        return f"Run {self.title!r}: {len(self.frame)} rows, {len(self.events)} events"

    def _repr_html_(self) -> str:
        return f"<p><b>{escape(repr(self))}</b></p>{self.frame.to_html(max_rows=8)}"
