"""Rigs: models with their numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from os import PathLike
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import pandas

from . import _native
from ._jobs import Interrupted, finish
from ._native import InputError
from ._run import Run
from ._tables import Path, Tabular, native

if TYPE_CHECKING:
    from typing import Self

_FMI_VERSIONS = (2, 3)


class Rig:
    """A rig: its parts, friction law and effects, with their numbers.

    Made by :meth:`from_toml`, :meth:`from_text`, :meth:`reduced` or :meth:`full`; what changes it returns another rig.

    Examples
    --------
    >>> import stickslip
    >>> rig = stickslip.Rig.reduced(disc_inertia=0.015)
    >>> rig["disc.inertia"]
    0.015
    >>> rig
    Rig 'reduced rig': reduced, stribeck
    """

    def __init__(self, native_rig: _native.Rig) -> None:
        self._native = native_rig

    @classmethod
    def from_toml(cls, path: Path) -> Self:
        """Read a model file.

        Parameters
        ----------
        path : str or path
            A ``model.toml``: SI units, shaft side of the gearbox unless a section is ``[motor]``.

        Returns
        -------
        Rig
            The rig that it describes.

        Raises
        ------
        InputError
            The file cannot be read or is no model of a rig; the message names section, key and what is right.
        """
        try:
            text = FilePath(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
        return cls.from_text(text, str(path))

    @classmethod
    def from_text(cls, text: str, name: str = "model") -> Self:
        """Read the text of a model file.

        Parameters
        ----------
        text : str
            What stands in a ``model.toml``.
        name : str
            What messages call it.

        Returns
        -------
        Rig
            The rig that it describes.
        """
        return cls(_native.Rig(text, name))

    @classmethod
    def reduced(cls, **changes: float | Mapping[str, float] | None) -> Self:
        """Make the dissertation's reduced rig: motor, gearbox, shaft and disc D2 under one pin.

        Parameters
        ----------
        **changes : float, mapping or None
            As for :meth:`with_`.

        Returns
        -------
        Rig
            The rig with those changes.
        """
        return cls.from_text(_native.REDUCED_RIG, "reduced rig").with_(**changes)

    @classmethod
    def full(cls, **changes: float | Mapping[str, float] | None) -> Self:
        """Make the dissertation's full rig, which has disc D1 on a second shaft beyond D2.

        Parameters
        ----------
        **changes : float, mapping or None
            As for :meth:`with_`.

        Returns
        -------
        Rig
            The rig with those changes.
        """
        return cls.from_text(_native.FULL_RIG, "full rig").with_(**changes)

    def with_(
        self,
        changes: Mapping[str, float | Mapping[str, float] | None] | None = None,
        /,
        **named: float | Mapping[str, float] | None,
    ) -> Self:
        """Make a rig with other numbers or effects.

        Parameters
        ----------
        changes : mapping, optional
            What is to change, by dotted names of parameters (``{"contact.mu_s": 0.25}``) or names of effects.
        **named : float, mapping or None
            The same with underscores for dots. A number [SI units] is a parameter's new value. A mapping switches an effect
            on, with all its numbers by their keys; None switches it off.

        Returns
        -------
        Rig
            The other rig. A number that is replaced keeps its relative uncertainty and loses its source.

        Examples
        --------
        >>> import stickslip
        >>> rig = stickslip.Rig.reduced()
        >>> rig.with_(contact_mu_s=0.25)["contact.mu_s"]
        0.25
        >>> rig.with_(unbalance={"torque": 0.04, "phase": 0.0}).effects
        ['unbalance']
        """
        rig = self._native
        numbers: list[tuple[str, float]] = []
        for name, change in {**(changes or {}), **named}.items():
            if change is None:
                rig = rig.without_effect(name)
            elif isinstance(change, Mapping):
                rig = rig.with_effect(name, [(key, float(value)) for key, value in change.items()])
            else:
                numbers.append((name, float(change)))
        # Together, for numbers that fit each other only in pairs; with the effects that are on by now.
        dotted = {name.replace(".", "_"): name for name, *_ in rig.parameters}
        known = [(dotted.get(name.replace("__", "_"), name), value) for name, value in numbers]
        return type(self)(rig.with_parameters(known) if known else rig)

    @property
    def name(self) -> str:
        """What messages call it: its file."""
        return self._native.name

    @property
    def kind(self) -> str:
        """The kind of rig: ``"reduced"`` or ``"full"``."""
        return self._native.kind

    @property
    def law(self) -> str:
        """Friction law of the pin on disc D2, as model files name it."""
        return self._native.law

    @property
    def effects(self) -> list[str]:
        """Names of the effects that are on."""
        return self._native.effects

    @property
    def parameters(self) -> pandas.DataFrame:
        """All parameters by dotted name: value, unit, relative uncertainty (one standard deviation) and description."""
        rows = [
            (name, value, unit, uncertainty, description)
            for name, value, unit, description, uncertainty in self._native.parameters
        ]
        columns = ["name", "value", "unit", "relative_uncertainty", "description"]
        return pandas.DataFrame(rows, columns=columns).set_index("name")

    @property
    def variables(self) -> pandas.DataFrame:
        """All variables of its FMUs by name: causality, unit, start, minimum, maximum and description."""
        columns = ["name", "causality", "unit", "start", "minimum", "maximum", "description"]
        return pandas.DataFrame(self._native.variables(), columns=columns).set_index("name")

    def to_toml(self) -> str:
        """Text of a model file of this rig.

        Returns
        -------
        str
            What :meth:`from_text` reads back, the same to the last bit.
        """
        return self._native.text

    def voltage_for(self, speed_rpm: float) -> float:
        """Compute the motor voltage that turns the undisturbed rig at a speed, as the dissertation's tests impose it.

        Parameters
        ----------
        speed_rpm : float
            Speed at the gearbox output [rpm].

        Returns
        -------
        float
            Voltage [V].
        """
        return self._native.voltage_for(speed_rpm * math.pi / 30)

    def simulate(
        self,
        *,
        speed_rpm: float | None = None,
        normal_force: float | None = None,
        normal_force_1: float | None = None,
        inputs: Tabular | Path | None = None,
        stop: float | None = None,
        step: float = 0.01,
        start: Mapping[str, float] | None = None,
        variables: Sequence[str] | None = None,
        derivatives: Iterable[str] = (),
        progress: bool = True,
    ) -> Run:
        """Run the rig.

        It is driven by a speed with normal forces, or by inputs over time.

        Parameters
        ----------
        speed_rpm : float, optional
            Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig.
        normal_force : float, optional
            Normal force N2 on disc D2 [N].
        normal_force_1 : float, optional
            Normal force N1 on disc D1 [N], of the full rig.
        inputs : table or path, optional
            Inputs over time with the columns ``u`` [V], ``N2`` [N] and, for the full rig, ``N1`` [N], of shape
            (rows,) each; times [s] are the index or a column ``time``. Values are held until the next row. Outputs among the
            columns are left aside, so that a measured record can drive a run as it is.
        stop : float, optional
            End of the run [s]; without it that of the inputs, or 60.
        step : float
            Time between the rows of the result [s]; the solution does not depend on it.
        start : mapping, optional
            States at the start that are not zero, by name: ``theta``, ``theta3``, ``theta1`` [rad], ``theta_dot``,
            ``theta3_dot``, ``theta1_dot`` [rad/s], ``i`` [A].
        variables : sequence of str, optional
            FMU variables to have as columns, such as ``der(theta_dot)``; without it inputs, outputs and what sticks.
        derivatives : iterable of str
            Parameters, by dotted name, with respect to which the states are differentiated, the inputs held as they are.
        progress : bool
            Whether a run that takes long shows a progress bar.

        Returns
        -------
        Run
            Columns over time, events, and the derivatives that were asked for.

        Raises
        ------
        InputError
            What was asked for cannot be; the message says what is right.
        Interrupted
            Ctrl-C; ``partial`` has the rows up to there.

        Examples
        --------
        >>> import stickslip
        >>> rig = stickslip.Rig.reduced()
        >>> run = rig.simulate(speed_rpm=55, normal_force=50, stop=10, derivatives=["contact.mu_s"])
        >>> run.frame.shape
        (1001, 11)
        >>> run.derivatives[("theta_dot", "contact.mu_s")].shape
        (1001,)
        """
        given = start or {}
        job = _native.simulate(
            self._native,
            _driven(speed_rpm, normal_force, normal_force_1, inputs),
            (stop, step),
            [(name, float(value)) for name, value in given.items()],
            None if variables is None else list(variables),
            [derivatives] if isinstance(derivatives, str) else list(derivatives),
        )
        ended = finish(job, "simulate", "row", progress)
        run = Run._of(self.name, ended.result)
        if ended.is_interrupted:
            raise Interrupted(f"interrupted; {len(run.frame)} rows are kept as `partial`", run)
        return run

    def build_fmu(
        self,
        out: Path,
        *,
        platforms: Iterable[str] = (),
        fmi: int | None = None,
        libraries: Iterable[Path] = (),
    ) -> list[FilePath]:
        """Write FMUs of this rig, for other tools.

        Parameters
        ----------
        out : str or path
            Folder for the FMUs; made if it is missing.
        platforms : iterable of str
            Platforms whose binaries are packed: ``linux64``, ``aarch64-linux``, ``win64``; without any all that the package has.
        fmi : int, optional
            Version of the standard, 2 or 3; both if not given.
        libraries : iterable of str or path
            Libraries of further platforms.

        Returns
        -------
        list of Path
            The files, for instance ``ReducedRig.fmi3.fmu``.
        """
        if fmi is not None and fmi not in _FMI_VERSIONS:
            raise InputError(f"fmi = {fmi}: 2 or 3 is needed, or nothing for both")
        versions = _FMI_VERSIONS if fmi is None else (fmi,)
        built = self._native.build(out, versions, list(platforms), list(libraries))
        return [FilePath(path) for path in built]

    def __getitem__(self, name: str) -> float:
        for own, value, *_ in self._native.parameters:
            if own == name:
                return value
        raise KeyError(f"{name}; {self.name} has {', '.join(own for own, *_ in self._native.parameters)}")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rig) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_text, (self.to_toml(), self.name)

    def __repr__(self) -> str:
        effects = "".join(f", {effect}" for effect in self.effects)
        return f"Rig {self.name!r}: {self.kind}, {self.law}{effects}"

    def _repr_html_(self) -> str:
        return f"<p><b>{escape(repr(self))}</b></p>{self.parameters.to_html(na_rep='')}"


def _driven(
    speed_rpm: float | None,
    normal_force: float | None,
    normal_force_1: float | None,
    inputs: Tabular | Path | None,
) -> tuple[float, float, float | None] | _native.Table | Path:
    held = {"speed_rpm": speed_rpm, "normal_force": normal_force, "normal_force_1": normal_force_1}
    if inputs is not None:
        both = [name for name, value in held.items() if value is not None]
        if both:
            raise InputError(f"{both[0]} cannot stand beside inputs; leave one of them out")
        return inputs if isinstance(inputs, (str, PathLike)) else native(inputs, "inputs", holes=False)
    if speed_rpm is None or normal_force is None:
        raise InputError("say what drives the rig: inputs, or speed_rpm with normal_force")
    return (speed_rpm, normal_force, normal_force_1)
