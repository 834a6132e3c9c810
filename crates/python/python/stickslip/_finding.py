"""Findings: what a diagnosis came to."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import pandas

from . import _tables
from ._rig import Rig
from ._tables import Path

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FILE = "finding.json"
_AMENDED = "model.amended.toml"
_REPORT = "report.html"


@dataclass(frozen=True)
class Number:
    """A number with its uncertainty.

    Attributes
    ----------
    value : float
        The value in ``unit``.
    interval95 : tuple of float or None
        Interval that covers the number with 95 % probability; None for a number that was not fitted.
    unit : str
        SI unit.
    model_parameter : str
        Dotted name in the model file.
    """

    value: float
    interval95: tuple[float, float] | None
    unit: str
    model_parameter: str

    @classmethod
    def _of(cls, number: Mapping[str, Any]) -> Number:
        interval = number["interval95"]
        return cls(
            number["value"], None if interval is None else tuple(interval), number["unit"], number["model_parameter"]
        )


@dataclass(frozen=True)
class Effect:
    """An effect that was added to the model.

    Attributes
    ----------
    name : str
        Name in the catalogue.
    probability : float
        Posterior probability of the set of effects that it belongs to, 0 … 1.
    parameters : dict
        Its numbers by short name, as :class:`Number`.
    """

    name: str
    probability: float
    parameters: dict[str, Number]


class Finding:
    """What a diagnosis found.

    Attributes
    ----------
    verdict : str
        ``nothing_missing``, ``parameters``, ``named``, ``ambiguous`` or ``not_in_catalogue``.
    effects : list of Effect
        What was added to the model, strongest first.
    alternatives : list of str
        With ``ambiguous``: the sets of effects that these records cannot tell apart.
    notes : list of str
        What had to be said about the records and the search.
    is_settled : bool or None
        Whether the model is now right as far as the records tell, the exit code 0 of the program; None for the finding of a
        diagnosis that was interrupted before the comparison.
    content : dict
        All of ``finding.json``.
    folder : Path
        Where its files are.
    """

    def __init__(
        self,
        folder: FilePath,
        is_settled: bool | None,
        screen: str,
        stretches: list[dict[str, bytearray]],
        place: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.folder = folder
        self.is_settled = is_settled
        self._screen = screen
        self._stretches = stretches
        # Its end is that of the files.
        self._place = place
        self._text = (folder / _FILE).read_text(encoding="utf-8")
        self.content: dict[str, Any] = json.loads(self._text)
        self.verdict: str = self.content["verdict"]
        self.alternatives: list[str] = self.content["alternatives"]
        self.notes: list[str] = self.content["notes"]
        self.effects = [
            Effect(
                effect["name"],
                effect["probability"],
                {name: Number._of(number) for name, number in effect["parameters"].items()},
            )
            for effect in self.content["effects"]
        ]

    def to_json(self) -> str:
        """Text of ``finding.json``.

        Returns
        -------
        str
            What ``docs/finding.schema.json`` describes.
        """
        return self._text

    @property
    def parameters(self) -> pandas.DataFrame:
        """Numbers of what was added and refitted nominal parameters: value, ends of the 95 % interval and unit."""
        added = [
            (number.model_parameter, effect.name, number) for effect in self.effects for number in effect.parameters.values()
        ]
        refitted = [(name, "", Number._of(number)) for name, number in self.content["parameters"].items()]
        rows = [
            (name, effect, number.value, *(number.interval95 or (None, None)), number.unit)
            for name, effect, number in [*added, *refitted]
        ]
        columns = ["parameter", "effect", "value", "low", "high", "unit"]
        return pandas.DataFrame(rows, columns=columns).set_index("parameter")

    @property
    def ranking(self) -> pandas.DataFrame:
        """Every set of effects that was fitted, best first; gains and margins in ln likelihood."""
        return pandas.DataFrame(self.content["ranking"])

    @property
    def where(self) -> pandas.DataFrame:
        """Coordinates over which the model that was believed leaves structure, strongest first."""
        return pandas.DataFrame(self.content["where"])

    @property
    def learned(self) -> pandas.DataFrame | None:
        """The function that the amended model has for what no effect explains; None where it has none.

        Knots as index, ``value``, ``low`` and ``high`` as columns; ``attrs`` has its name, port, coordinate, equation and units.
        """
        learned = self.content.get("learned")
        if learned is None:
            return None
        low, high = zip(*learned["interval95"], strict=True)
        index = pandas.Index(learned["knots"], name=learned["coordinate"])
        frame = pandas.DataFrame({"value": learned["values"], "low": low, "high": high}, index=index)
        frame.attrs = {key: learned[key] for key in ("name", "port", "coordinate", "equation", "coordinate_unit", "unit")}
        return frame

    @property
    def gap_closed(self) -> float | None:
        """Share of the held-out record's gap that the amended model closes, through its FMU; None where there was no gap."""
        gap = self.content["gap"]
        through = (gap or {}).get("through_fmu", {})
        closed: float | None = through.get("closed")
        return closed

    @property
    def amended(self) -> Rig:
        """The amended model."""
        return Rig.from_toml(self.folder / _AMENDED)

    @property
    def fmus(self) -> list[FilePath]:
        """The amended model's FMUs; none of a small plant."""
        return sorted(self.folder.glob("*.fmu"))

    @property
    def report(self) -> FilePath:
        """The report, a page for a browser."""
        return self.folder / _REPORT

    @property
    def experiment(self) -> pandas.DataFrame | None:
        """With ``ambiguous``: inputs over time [s] that would tell the alternatives apart, if there are any."""
        given = self.content["experiment"]
        if given is None:
            return None
        return _tables.read(self.folder / given["file"])

    @property
    def held_out(self) -> list[pandas.DataFrame]:
        """Each stretch of the held-out record over time [s]: what was measured, and both models restarted from it in windows.

        Columns are pairs of a variable [SI units] and ``record``, ``before`` or ``after``. Empty for small plants.
        """
        return [self._stretch(stretch) for stretch in self._stretches]

    @staticmethod
    def _stretch(stretch: Mapping[str, bytearray]) -> pandas.DataFrame:
        times = pandas.Index(_tables.floats(stretch["time"]), name="time")
        data = {
            (name.split(" ")[0], (name.split(" ") + ["record"])[1]): _tables.floats(values)
            for name, values in stretch.items()
            if name != "time"
        }
        frame = pandas.DataFrame(data, index=times)
        frame.columns.names = ["variable", "course"]
        return frame

    def figure(self) -> Figure:
        """Draw the held-out record with both models.

        Returns
        -------
        matplotlib.figure.Figure
            A panel for each variable that was measured; it is not shown.
        """
        from . import _figures

        return _figures.of_held_out(self)

    def candidates_figure(self) -> Figure:
        """Draw the sets of effects that were tried, with what they gain.

        Returns
        -------
        matplotlib.figure.Figure
            Gains with their 95 % intervals; it is not shown.
        """
        from . import _figures

        return _figures.of_candidates(self)

    def save(self, folder: Path) -> FilePath:
        """Copy the files of the finding.

        Parameters
        ----------
        folder : str or path
            Where to; made if it is missing, files of the same names are replaced.

        Returns
        -------
        Path
            The folder.
        """
        shutil.copytree(self.folder, folder, dirs_exist_ok=True)
        return FilePath(folder)

    def __str__(self) -> str:
        return self._screen

    def __repr__(self) -> str:
        effects = f": {' + '.join(effect.name for effect in self.effects)}" if self.effects else ""
        return f"Finding {self.verdict}{effects}"

    def _repr_html_(self) -> str:
        return (
            f"<p><b>{escape(repr(self))}</b></p><pre>{escape(self._screen)}</pre>"
            f"{self.parameters.to_html(na_rep='', float_format='{:.4g}'.format)}"
        )
