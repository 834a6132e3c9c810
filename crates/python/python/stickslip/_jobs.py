"""Long work: waiting for it, showing how far it is, stopping it."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

from . import _native
from ._native import InputError
from ._tables import Path

# Seconds between two looks at the work.
_INTERVAL = 0.1
# Seconds after which a progress bar is worth showing.
_PATIENCE = 0.5


class Interrupted(KeyboardInterrupt):
    """Work that Ctrl-C stopped; what is finished is kept.

    Attributes
    ----------
    partial : Run, Map, Ensemble, Finding or None
        What is finished.
    """

    def __init__(self, message: str, partial: Any = None) -> None:
        super().__init__(message)
        self.partial = partial


class _Engine:
    """The threads of the engine that diagnoses: they stay behind where the process is forked."""

    is_used = False
    is_lost = False

    @classmethod
    def forked(cls) -> None:
        """Note, in the child, what a fork leaves behind."""
        cls.is_lost = cls.is_used


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_Engine.forked)


def need_engine() -> None:
    """Refuse what would wait for threads that a fork has left behind, for ever."""
    if _Engine.is_lost:
        raise InputError(
            "this process was forked from one that had read a case, whose threads stay there; start processes with "
            "multiprocessing.get_context('spawn'), or read the first case after the fork"
        )
    _Engine.is_used = True


@dataclass(frozen=True)
class Ended:
    """How work ended: what it came to, and whether it was interrupted."""

    result: Any
    is_interrupted: bool


def finish(job: _native.Job, title: str, unit: str, progress: bool) -> Ended:
    """Wait for work, with a progress bar if it takes longer; Ctrl-C stops it, and a second one leaves it alone."""
    try:
        if job.wait(_PATIENCE):
            return Ended(job.result(), is_interrupted=False)
        with _bar(title, unit, progress) as bar:
            while not job.wait(_INTERVAL):
                _show(bar, job)
            _show(bar, job)
    except KeyboardInterrupt:
        job.stop()
        while not job.wait(_INTERVAL):
            pass
        return Ended(job.result(), is_interrupted=True)
    return Ended(job.result(), is_interrupted=False)


def finish_in(out: Path | None, begin: Callable[[FilePath], _native.Job], title: str, progress: bool) -> tuple[Ended, str]:
    """Runs whose finished ones are kept in a folder, if one is given: how they ended, and where they are if in the middle."""
    with tempfile.TemporaryDirectory(prefix="stickslip-") as place:
        folder = FilePath(out) if out is not None else FilePath(place)
        ended = finish(begin(folder), title, "run", progress)
    kept = f"kept in {out}: the same call goes on from there" if out is not None else "kept as `partial`"
    return ended, kept


def _bar(title: str, unit: str, progress: bool) -> Any:
    with warnings.catch_warnings():
        # Without the widgets of notebooks the bar is one of text, as it should be.
        warnings.simplefilter("ignore")
        from tqdm.auto import tqdm
    return tqdm(desc=title, unit=unit, disable=not progress, leave=False)


def _show(bar: Any, job: _native.Job) -> None:
    done, total = job.progress
    bar.total = total or None
    # Where nobody knows how much there is to do, a count of nothing says nothing.
    bar.bar_format = None if total else "{desc}: {elapsed}{postfix}"
    bar.set_postfix_str(job.message, refresh=False)
    bar.update(done - bar.n)
    bar.refresh()
