"""Scores: diagnoses of cases whose answers are known."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from html import escape
from pathlib import Path as FilePath

import pandas

from . import _native
from ._jobs import Interrupted, finish, need_engine
from ._tables import Path


@dataclass(frozen=True)
class Score:
    """How well findings fit the answers.

    Attributes
    ----------
    frame : pandas.DataFrame
        A row for each figure, as in ``score.json``: what it is, its value with interval and cases, and the bar.
    markdown : str
        The same for people, with the table of what was said.
    failed : list of str
        Cases that could not be diagnosed, with the reason.
    is_passed : bool
        Whether every bar is reached and every case was diagnosed.
    """

    frame: pandas.DataFrame
    markdown: str
    failed: list[str]
    is_passed: bool

    def __repr__(self) -> str:
        return self.markdown

    def _repr_html_(self) -> str:
        failed = "".join(f"<li>{escape(line)}</li>" for line in self.failed)
        return f"{self.frame.to_html(na_rep='')}<ul>{failed}</ul>"


def score(
    cases: Path,
    *,
    out: Path | None = None,
    leave_one_out: bool = False,
    jobs: int = 1,
    library: Path | None = None,
    progress: bool = True,
) -> Score:
    """Diagnose cases whose answers are known, and judge the findings.

    Parameters
    ----------
    cases : str or path
        Folder with ``ANSWERS.json`` and a folder for each case.
    out : str or path, optional
        Folder for findings, ``score.json`` and ``score.md``; findings that are there already are not made again.
    leave_one_out : bool
        Diagnose each case once more with the right effects taken out of the catalogue.
    jobs : int
        Cases diagnosed at a time; each uses all cores.
    library : str or path, optional
        The library to pack into FMUs; without it that of the package.
    progress : bool
        Whether a progress bar is shown.

    Returns
    -------
    Score
        The figures.

    Raises
    ------
    InputError
        There are no answers, or results cannot be written.
    Interrupted
        Ctrl-C; the findings that are finished are kept in ``out``.
    """
    need_engine()
    with tempfile.TemporaryDirectory(prefix="stickslip-") as place:
        folder = FilePath(out) if out is not None else FilePath(place)
        job = _native.score(cases, folder, leave_one_out, jobs, library)
        ended = finish(job, "score", "case", progress)
        if ended.result is None:
            kept = f"kept in {out}: the same call goes on from there" if out is not None else "lost: name a folder `out`"
            raise Interrupted(f"interrupted; findings that are finished are {kept}")
        markdown, failed, is_passed = ended.result
        table = json.loads((folder / "score.json").read_text(encoding="utf-8"))["table"]
    return Score(pandas.DataFrame(table), markdown, failed, is_passed)
