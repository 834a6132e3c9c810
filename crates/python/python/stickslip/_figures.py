"""Figures of matplotlib: returned, never shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ._native import InputError

if TYPE_CHECKING:
    from ._ensemble import Ensemble
    from ._finding import Finding
    from ._map import Map
    from ._run import Run

_LABELS = {
    "theta": "θ2 [rad]",
    "theta_dot": "ω2 [rad/s]",
    "theta3": "θ3 [rad]",
    "theta3_dot": "ω3 [rad/s]",
    "i": "i [A]",
    "theta1": "θ1 [rad]",
    "theta1_dot": "ω1 [rad/s]",
}
_AXES = {"speed_rpm": "speed [rpm]", "normal_force": "N2 [N]", "normal_force_1": "N1 [N]"}
_MOTIONS = ["no_motion", "sticking", "stick_slip", "oscillation", "steady", "failed"]
_COLOURS = ["#bbbbbb", "#4477aa", "#ee6677", "#ccbb44", "#228833", "#000000"]
_STYLES: dict[str, dict[str, Any]] = {
    "record": {"linestyle": "", "marker": ".", "markersize": 3, "color": "0.5"},
    "before": {"linewidth": 1, "color": "tab:orange"},
    "after": {"linewidth": 1, "color": "tab:blue"},
}
# Candidates that a figure shows.
_MOST = 12


class _Figure(Figure):
    """A figure that notebooks display without pyplot, which would show it by itself."""

    def __init__(self, width: float, height: float) -> None:
        super().__init__(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        import io

        content = io.BytesIO()
        self.savefig(content, format="png", dpi=100)
        return content.getvalue()


def of_run(run: Run) -> Figure:
    """Velocities over friction torque."""
    missing = [name for name in ("theta_dot", "theta3_dot", "T_f") if name not in run.frame]
    if missing:
        raise InputError(f"the run has no column {', '.join(missing)}; leave out `variables` or draw run.frame.plot()")
    figure = _Figure(9, 5)
    velocity, friction = figure.subplots(2, sharex=True)
    for name, label in [("theta3_dot", "gearbox output"), ("theta1_dot", "disc D1"), ("theta_dot", "disc D2")]:
        if name in run.frame:
            velocity.plot(run.frame.index, run[name], label=label, linewidth=1)
    velocity.set(ylabel="velocity [rad/s]", title=run.title)
    velocity.legend(loc="upper right")
    friction.plot(run.frame.index, run["T_f"], color="tab:red", linewidth=1)
    friction.set(xlabel="time [s]", ylabel="friction torque [N m]")
    return figure


def of_map(made: Map) -> Figure:
    """Kinds of motion over two quantities, extrema over one."""
    figure = _Figure(8, 5)
    axes: Any = figure.subplots()
    if len(made.axes) == 1:
        (across,) = made.axes
        axes.plot(made.extrema[across], made.extrema["velocity_extremum"], ".", markersize=2)
        axes.set(xlabel=_AXES.get(across, across), ylabel="local extrema of ω2 [rad/s]")
        return figure
    across, upward = made.axes
    codes = made.frame["motion"].map(_MOTIONS.index)
    grid = made.frame.assign(code=codes).pivot(index=upward, columns=across, values="code")
    image = axes.pcolormesh(
        grid.columns, grid.index, grid.to_numpy(), cmap=ListedColormap(_COLOURS), vmin=-0.5, vmax=len(_MOTIONS) - 0.5
    )
    bar = figure.colorbar(image, ax=axes, ticks=range(len(_MOTIONS)))
    bar.ax.set_yticklabels([name.replace("_", " ") for name in _MOTIONS])
    axes.set(xlabel=_AXES.get(across, across), ylabel=_AXES.get(upward, upward))
    return figure


def of_ensemble(made: Ensemble) -> Figure:
    """Probability of stick-slip over two quantities or one, half amplitudes at one place."""
    figure = _Figure(8, 5)
    axes: Any = figure.subplots()
    varied = [name for name in ("speed_rpm", "normal_force") if made.frame[name].nunique() > 1]
    if len(varied) == 2:
        across, upward = varied
        grid = made.frame.pivot(index=upward, columns=across, values="stick_slip")
        image = axes.pcolormesh(grid.columns, grid.index, grid.to_numpy(), vmin=0, vmax=1)
        figure.colorbar(image, ax=axes, label="probability of stick-slip")
        axes.set(xlabel=_AXES[across], ylabel=_AXES[upward])
    elif varied:
        x = made.frame[varied[0]]
        axes.fill_between(x, made.frame["stick_slip_low"], made.frame["stick_slip_high"], alpha=0.3, label="95 % interval")
        axes.plot(x, made.frame["stick_slip"])
        axes.set(xlabel=_AXES[varied[0]], ylabel="probability of stick-slip", ylim=(-0.03, 1.03))
        axes.legend()
    else:
        axes.hist(made.runs["half_amplitude"].dropna(), bins=40)
        axes.set(xlabel="half amplitude of ω2 [rad/s]", ylabel="rigs")
    return figure


def of_held_out(finding: Finding) -> Figure:
    """The held-out record with both models, a panel for each variable."""
    stretches = finding.held_out
    if not stretches:
        raise InputError("there is no comparison to draw: the diagnosis was interrupted, or its plant is a small one")
    names = list(dict.fromkeys(name for stretch in stretches for name in stretch.columns.get_level_values("variable")))
    figure = _Figure(9, 1 + 2 * len(names))
    panels = numpy.atleast_1d(figure.subplots(len(names), sharex=True))
    for panel, name in zip(panels, names, strict=True):
        for at, stretch in enumerate(stretches):
            if name not in stretch:
                continue
            course: Any = stretch[name]
            for which, style in _STYLES.items():
                panel.plot(course.index, course[which], label=which if at == 0 else None, **style)
        panel.set(ylabel=_LABELS.get(name, name))
    panels[0].set(title=f"{finding!r}, held-out record")
    panels[0].legend(loc="upper right")
    panels[-1].set(xlabel="time [s]")
    return figure


def of_candidates(finding: Finding) -> Figure:
    """Gains of the sets of effects with their intervals."""
    ranking = finding.ranking.head(_MOST)
    if ranking.empty:
        raise InputError("no set of effects was tried")
    figure = _Figure(8, 1.2 + 0.3 * len(ranking))
    axes: Any = figure.subplots()
    low, high = numpy.array(ranking["interval95"].tolist()).T
    gain = ranking["gain"].to_numpy()
    axes.errorbar(gain, range(len(ranking)), xerr=[gain - low, high - gain], fmt="o", capsize=3)
    axes.set_yticks(range(len(ranking)), [name.replace("_", " ") for name in ranking["name"]])
    axes.invert_yaxis()
    axes.axvline(0, color="0.8")
    axes.set(xlabel="gain in ln likelihood on windows that were not fitted to")
    return figure
