"""The examples of docs/tables.md read a small file of each kind, and what they read makes a case."""

from __future__ import annotations

import pathlib
import re
import shutil
from typing import Any

import nptdms
import numpy
import pandas
import polars
import pytest
from asammdf import MDF, Signal
from conftest import CASE, ROOT
from scipy.io import savemat

import stickslip

PAGE = ROOT / "docs" / "tables.md"
RECORD = pandas.read_csv(CASE / "run-a.csv", index_col="time")


def write_all(folder: pathlib.Path) -> None:
    """A file of each kind with the same record."""
    RECORD.to_csv(folder / "run.csv")
    with pandas.ExcelWriter(folder / "run.xlsx") as book:
        RECORD.to_excel(book, sheet_name="bench", startrow=2)
    RECORD.to_parquet(folder / "run.parquet")
    polars.DataFrame(RECORD.reset_index()).write_parquet(folder / "run-polars.parquet")
    columns = {str(name): RECORD[name].to_numpy() for name in RECORD}
    savemat(folder / "run.mat", {"t": RECORD.index.to_numpy(), **columns})
    savemat(folder / "run-log.mat", {"log": {"time": RECORD.index.to_numpy(), **columns}})
    with MDF() as file:
        file.append([Signal(samples=values, timestamps=RECORD.index.to_numpy(), name=name) for name, values in columns.items()])
        file.save(folder / "run.mf4", overwrite=True)
    with nptdms.TdmsWriter(folder / "run.tdms") as writer:
        properties = {"wf_start_offset": 0.0, "wf_increment": 0.01}
        writer.write_segment(
            [nptdms.ChannelObject("bench", name, values, properties=properties) for name, values in columns.items()]
        )


def blocks() -> list[tuple[str, str]]:
    """The page's Python blocks that read a record, with their section."""
    found, section = [], ""
    for heading, code in re.findall(r"(?m)^## (.+)$|(?s:^```python\n(.*?)^```)", PAGE.read_text()):
        section = heading or section
        if "record =" in code:
            found.append((section, code))
    return found


def identifiers() -> list[str]:
    sections = [section for section, _ in blocks()]
    return [f"{section}-{sections[:at].count(section)}" for at, section in enumerate(sections)]


@pytest.mark.parametrize(("section", "code"), blocks(), ids=identifiers())
def test_an_example_reads_its_file(section: str, code: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_all(tmp_path)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(code, f"{PAGE.name}, {section}", "exec"), names)
    record = names["record"]
    case = stickslip.Case(CASE / "model.toml", [record], held_out=CASE / "held-out.csv")
    assert case.notes
    if isinstance(record, str):
        assert stickslip.Case(CASE / "model.toml", [names["part"]], held_out=CASE / "held-out.csv").notes
        return
    frame = record.to_pandas().set_index("time") if isinstance(record, polars.DataFrame) else record
    assert len(frame) == len(RECORD)
    assert numpy.abs(frame.index.to_numpy(float) - RECORD.index.to_numpy()).max() < 1e-9
    for name in frame:
        # A raster is interpolated.
        assert numpy.abs(frame[name].to_numpy() - RECORD[name].to_numpy()).max() < 1e-9, name


def test_parquet_and_excel_give_the_finding_of_csv_bit_for_bit(tmp_path: pathlib.Path) -> None:
    found = {}
    for kind in ("csv", "parquet", "xlsx"):
        folder = tmp_path / kind / "case"
        folder.mkdir(parents=True)
        shutil.copy(CASE / "model.toml", folder)
        for path in CASE.glob("*.csv"):
            record = pandas.read_csv(path, index_col="time")
            write = {"csv": "to_csv", "parquet": "to_parquet", "xlsx": "to_excel"}[kind]
            getattr(record, write)(folder / f"{path.stem}.{kind}")
        finding = stickslip.Case.from_directory(folder).diagnose(progress=False)
        text = finding.to_json().replace(f".{kind}", ".csv").replace(str(folder), "case")
        found[kind] = re.sub(r'"seconds": [0-9.e-]+', "", text)
    assert found["csv"] == found["parquet"] == found["xlsx"]


def test_dates_sheets_and_parts_of_files(tmp_path: pathlib.Path) -> None:
    dated = RECORD.set_axis(pandas.Timestamp("2026-03-29 01:59", tz="Europe/Berlin") + pandas.to_timedelta(RECORD.index, unit="s"))
    dated.rename_axis("time").to_parquet(tmp_path / "dated.parquet")
    dated.tz_localize(None).rename_axis("time").to_excel(tmp_path / "dated.xlsx")
    with pandas.ExcelWriter(tmp_path / "two.xlsx") as book:
        RECORD.to_excel(book, sheet_name="monday")
        RECORD.to_excel(book, sheet_name="tuesday")
    held_out = CASE / "held-out.csv"
    for name in ("dated.parquet@0:6", "dated.xlsx@0:6", "two.xlsx#tuesday@0:6"):
        case = stickslip.Case(CASE / "model.toml", [tmp_path / name], held_out=held_out)
        dates = "`time` taken as seconds since the first row"
        assert any(dates in note for note in case.notes) == name.startswith("dated"), case.notes
    with pytest.raises(stickslip.InputError, match="two.xlsx: has tables in 2 sheets; say which one is meant, such as .*#monday"):
        stickslip.Case(CASE / "model.toml", [tmp_path / "two.xlsx"], held_out=held_out)
    RECORD.assign(operator="Smith").to_parquet(tmp_path / "text.parquet")
    with pytest.raises(stickslip.InputError, match="text.parquet: column `operator` holds text or objects; numbers are needed"):
        stickslip.Case(CASE / "model.toml", [tmp_path / "text.parquet"], held_out=held_out)


def test_every_kind_has_an_example() -> None:
    assert {section for section, _ in blocks()} == {"CSV", "Excel", "Parquet", "MATLAB", "MDF4", "TDMS"}


def test_the_columns_of_the_page_are_taken() -> None:
    code = re.findall(r"(?s)```python\n(columns = .*?)```", PAGE.read_text())[0]
    names: dict[str, Any] = {}
    exec(code, names)

    def as_on_the_page(record: pandas.DataFrame) -> pandas.DataFrame:
        changed = record.assign(theta_dot=record["theta_dot"] * 30 / numpy.pi, shunt=0.01 + 0.001 * numpy.sin(record.index))
        return changed.assign(**{"disc encoder": numpy.degrees(record["theta"])}).drop(columns="theta")

    held_out = pandas.read_csv(CASE / "held-out.csv", index_col="time")
    case = stickslip.Case(
        CASE / "model.toml", [as_on_the_page(RECORD)], held_out=as_on_the_page(held_out), columns=names["columns"]
    )
    (said,) = [note for note in case.notes if note.startswith("read from")]
    for part in ("from rpm to rad/s", "`disc encoder` taken as theta", "`shunt` taken as i"):
        assert part in said, said
