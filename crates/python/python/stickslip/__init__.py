"""Friction-induced stick-slip of a motor-driven torsional rig.

Simulate a rig, build FMUs of it, map its kinds of motion, and find what a model of it lacks, from measured records.

>>> import stickslip
>>> rig = stickslip.Rig.reduced()
>>> run = rig.simulate(speed_rpm=55, normal_force=50, stop=20)
>>> run.summary.motion
'stick_slip'

Tables are pandas tables with the time [s] as index and FMU variable names as columns, in SI units; rpm only where a name
says so. Results are those of the programs ``stickslip`` and ``build-fmu``, which this package brings along, bit for bit.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._native import DefectError, InputError, __version__

if TYPE_CHECKING:
    from ._case import Case
    from ._ensemble import Ensemble, ensemble
    from ._finding import Effect, Finding, Number
    from ._jobs import Interrupted
    from ._map import Map, map
    from ._rig import Rig
    from ._run import Run, Summary
    from ._score import Score, score

__all__ = [
    "Case",
    "DefectError",
    "Effect",
    "Ensemble",
    "Finding",
    "InputError",
    "Interrupted",
    "Map",
    "Number",
    "Rig",
    "Run",
    "Score",
    "Summary",
    "__version__",
    "ensemble",
    "map",
    "score",
]

_native.look_for_libraries_in(Path(__file__).parent / "libraries")

# Loaded when they are asked for, so that the programs need not wait for pandas.
_MODULES = {
    "Case": "_case",
    "Effect": "_finding",
    "Ensemble": "_ensemble",
    "Finding": "_finding",
    "Interrupted": "_jobs",
    "Map": "_map",
    "Number": "_finding",
    "Rig": "_rig",
    "Run": "_run",
    "Score": "_score",
    "Summary": "_run",
    "ensemble": "_ensemble",
    "map": "_map",
    "score": "_score",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
    value = getattr(importlib.import_module(f".{_MODULES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
