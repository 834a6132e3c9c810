"""The native module, as the package's own modules use it. Columns are 64-bit floats: buffers in, bytes out."""

from collections.abc import Sequence
from os import PathLike
from typing import Any, final

import numpy
from numpy.typing import NDArray

_Floats = NDArray[numpy.float64]



__all__ = [
    "Case",
    "DefectError",
    "FULL_RIG",
    "InputError",
    "Job",
    "REDUCED_RIG",
    "Rig",
    "Table",
    "__version__",
    "build_fmu",
    "ensemble",
    "look_for_libraries_in",
    "map",
    "score",
    "simulate",
    "split_columns",
    "stickslip",
]
__version__: str
REDUCED_RIG: str
FULL_RIG: str

class InputError(ValueError):
    """What the command line answers with exit code 2: something about the input is wrong, and the message says what is right."""

class DefectError(RuntimeError):
    """The program itself is wrong: please report the message with what led to it."""

@final
class Table:
    def __new__(cls, name: str, time: _Floats, columns: Sequence[tuple[str, _Floats]]) -> Table: ...

@final
class Job:
    def wait(self, seconds: float) -> bool: ...
    def stop(self) -> None: ...
    @property
    def message(self) -> str: ...
    @property
    def progress(self) -> tuple[int, int]: ...
    def result(self) -> Any: ...

@final
class Rig:
    def __new__(cls, text: str, name: str) -> Rig: ...
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def law(self) -> str: ...
    @property
    def effects(self) -> list[str]: ...
    @property
    def parameters(self) -> list[tuple[str, float, str, str, float | None]]: ...
    def variables(self) -> list[tuple[str, str, str, float | None, float | None, float | None, str]]: ...
    def with_parameters(self, values: Sequence[tuple[str, float]]) -> Rig: ...
    def with_effect(self, effect: str, values: Sequence[tuple[str, float]]) -> Rig: ...
    def without_effect(self, effect: str) -> Rig: ...
    def voltage_for(self, speed: float) -> float: ...
    def build(
        self,
        out: str | PathLike[str],
        versions: Sequence[int],
        platforms: Sequence[str],
        libraries: Sequence[str | PathLike[str]],
    ) -> list[str]: ...

@final
class Case:
    def __new__(
        cls,
        name: str,
        model: tuple[str, str],
        records: Sequence[Table | str | PathLike[str]],
        held_out: Table | str | PathLike[str] | None,
        sensors: tuple[str, str] | None,
        effects: Sequence[tuple[str, str]],
        without: Sequence[str],
    ) -> Case: ...
    @staticmethod
    def in_directory(directory: str | PathLike[str], without: Sequence[str]) -> Case: ...
    @property
    def name(self) -> str: ...
    @property
    def model_text(self) -> str: ...
    @property
    def model_name(self) -> str: ...
    @property
    def is_of_small_plant(self) -> bool: ...
    def check(self) -> Job: ...
    def diagnose(self, out: str | PathLike[str], library: str | PathLike[str] | None) -> Job: ...
    def left(self, out: str | PathLike[str]) -> tuple[list[str], str]: ...

def look_for_libraries_in(folder: str | PathLike[str]) -> None: ...
def split_columns(text: str) -> tuple[str, str]: ...
def simulate(
    rig: Rig,
    driven: tuple[float, float, float | None] | Table | str | PathLike[str],
    times: tuple[float | None, float],
    start: Sequence[tuple[str, float]],
    variables: Sequence[str] | None,
    by: Sequence[str],
) -> Job: ...
def ensemble(
    rig: Rig,
    spans: tuple[str, str, float | None],
    number: tuple[int, int],
    drawn: tuple[Sequence[str], Sequence[tuple[str, float]]],
    lengths: tuple[float, float],
    threads: int | None,
    out: str | PathLike[str],
) -> Job: ...
def map(
    rig: Rig,
    spans: tuple[str, str, str | None, Sequence[tuple[str, str]]],
    duration: float,
    tolerance: float,
    threads: int | None,
    out: str | PathLike[str],
) -> Job: ...
def score(
    cases: str | PathLike[str],
    out: str | PathLike[str],
    leave_one_out: bool,
    jobs: int,
    library: str | PathLike[str] | None,
) -> Job: ...
def stickslip(arguments: Sequence[str]) -> int: ...
def build_fmu(arguments: Sequence[str]) -> int: ...
