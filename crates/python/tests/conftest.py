"""What the tests share: the installed package, the programs that cargo built, a case and its records."""

from __future__ import annotations

import pathlib
import shutil
import subprocess
import sys
from collections.abc import Callable

import pandas
import pytest

import stickslip

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILT = ROOT / "target" / "release"
LIBRARY = BUILT / "libstickslip.so"
INSTALLED = pathlib.Path(sys.executable).parent
CASE = ROOT / "crates" / "workbench" / "tests" / "data" / "unbalance"
MODELS = ROOT / "modelDescription"


def run(program: pathlib.Path, *words: object) -> subprocess.CompletedProcess[str]:
    """A program's exit code and what it said."""
    return subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, timeout=300)


def table(path: pathlib.Path) -> pandas.DataFrame:
    """A CSV file of the program's as a table with the time as index, the same numbers to the last bit."""
    rows = [line.split(",") for line in path.read_text().splitlines()]
    numbers = [[float(word) for word in row] for row in rows[1:]]
    return pandas.DataFrame(numbers, columns=rows[0]).set_index("time")


@pytest.fixture(scope="session")
def records() -> dict[str, pandas.DataFrame]:
    """The records of the case by the names of their files."""
    return {path.stem: table(path) for path in sorted(CASE.glob("*.csv"))}


@pytest.fixture
def refused() -> Callable[..., str]:
    """The message of the error that a call raises."""

    def message(call: Callable[..., object], *arguments: object, **named: object) -> str:
        with pytest.raises(stickslip.InputError) as caught:
            call(*arguments, **named)
        return str(caught.value)

    return message


@pytest.fixture
def case_copy(tmp_path: pathlib.Path) -> pathlib.Path:
    """A copy of the case's folder."""
    return pathlib.Path(shutil.copytree(CASE, tmp_path / "case"))
