"""Every closed-loop example runs, ends stick-slip, agrees with the others and leaves its table and picture."""

import csv
import pathlib
import subprocess
import sys

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = ROOT / "out" / "closed-loop"  # kept: CI's pictures
EXAMPLES = {
    "with_ecos": ["FMI 2", "FMI 3", "FMI 2 from SSP", "FMI 3 from SSP"],
    "with_libcosim": ["FMI 2", "FMI 2 from SSP"],
    "as_one_fmu": ["FMI 2", "FMI 3"],
    "with_my_controller": ["MyController (Python)"],
}


def columns(path):
    with open(path) as file:
        head, *rows = csv.reader(file)
    return dict(zip(head, numpy.array(rows, float).T))


@pytest.fixture(scope="module")
def results():
    """Columns of every example's table."""
    tables = {}
    for name in EXAMPLES:
        for left in OUT.glob(f"{name}.*"):
            left.unlink()
        script = ROOT / "docs" / "examples" / "closed-loop" / f"{name}.py"
        result = subprocess.run([sys.executable, script, "--out", OUT], capture_output=True, text=True)
        assert result.returncode == 0, f"{name}: {result.stdout}{result.stderr}"
        assert (OUT / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        tables[name] = columns(OUT / f"{name}.csv")
    return tables


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_disc_turns_at_the_wanted_speed_and_does_not_stick(results, name):
    table = results[name]
    assert list(table) == ["time", *EXAMPLES[name]]
    for label in EXAMPLES[name]:
        late = table[label][table["time"] > 15.0]
        assert len(late) > 4000
        assert numpy.abs(late - 55 * 2 * numpy.pi / 60).max() < 1e-3, label


def test_masters_agree_where_they_exchange_at_the_same_instants(results):
    reference = results["with_ecos"]["FMI 2"]
    for name in ("with_ecos", "with_libcosim", "as_one_fmu"):
        for label in EXAMPLES[name]:
            difference = numpy.abs(results[name][label] - reference).max()
            print(f"{name}, {label}: {difference:.1e} rad/s from ecos, FMI 2")
            assert difference < 1e-9, (name, label)
