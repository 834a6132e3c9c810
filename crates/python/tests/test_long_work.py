"""Long work lets other threads run, stops at Ctrl-C and keeps what is finished."""

from __future__ import annotations

import json
import pathlib
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pandas
import pytest
from conftest import CASE, INSTALLED

import stickslip


def interrupted_after(seconds: float, script: str) -> tuple[str, float]:
    """What a script prints that is interrupted, and how long it then takes to end [s]."""
    begin = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\nimport stickslip\nprint('begun', flush=True)\n"
    process = subprocess.Popen(
        [sys.executable, "-c", begin + textwrap.dedent(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    out, error = process.communicate(timeout=120)
    assert process.returncode == 0, error
    return out, time.monotonic() - sent


def test_other_threads_run_meanwhile() -> None:
    rig, turns, done = stickslip.Rig.reduced(), 0, threading.Event()

    def count() -> None:
        nonlocal turns
        while not done.wait(0.01):
            turns += 1

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    stickslip.map(rig, speed_rpm=(20, 80, 40), normal_force=(1, 80, 40), threads=1, progress=False)
    seconds = time.monotonic() - begun
    done.set()
    thread.join()
    assert turns > 0.3 * seconds / 0.01


def test_an_interrupted_map_keeps_its_rows_and_goes_on(tmp_path: pathlib.Path) -> None:
    call = f"stickslip.map(stickslip.Rig.reduced(), speed_rpm=(20, 80, 40), normal_force=(1, 80, 200), threads=1, out={str(tmp_path)!r})"
    out, seconds = interrupted_after(
        1.5,
        f"""
        try:
            {call}
        except stickslip.Interrupted as stopped:
            print(len(stopped.partial.frame), stopped)
        """,
    )
    count, message = out.split(maxsplit=1)
    assert 0 < int(count) < 40 * 200 and int(count) % 40 == 0
    assert "the same call goes on from there" in message
    assert seconds < 2
    rig = stickslip.Rig.reduced()
    made = stickslip.map(rig, speed_rpm=(20, 80, 40), normal_force=(1, 80, 200), threads=1, out=tmp_path)
    assert len(made.frame) == 40 * 200
    head = made.frame.iloc[: 2 * 40]
    again = stickslip.map(rig, speed_rpm=(20, 80, 40), normal_force=tuple(made.frame["normal_force"].unique()[:2]) + (2,))
    pandas.testing.assert_frame_equal(head, again.frame, check_exact=True)


def test_an_interrupted_ensemble_keeps_its_rigs_and_goes_on(tmp_path: pathlib.Path) -> None:
    words = "speed_rpm=(20, 80, 10), normal_force=(1, 60, 5), runs=300, seed=2, threads=1"
    call = f"stickslip.ensemble(stickslip.Rig.reduced(), {words}, out={str(tmp_path)!r})"
    out, _ = interrupted_after(
        1.5,
        f"""
        try:
            {call}
        except stickslip.Interrupted as stopped:
            print(len(stopped.partial.rigs), len(stopped.partial.runs), stopped)
        """,
    )
    rigs, runs, message = out.split(maxsplit=2)
    assert 0 < int(rigs) < 300 and int(runs) == 50 * int(rigs)
    assert "the same call goes on from there" in message
    rig = stickslip.Rig.reduced()
    made = stickslip.ensemble(rig, speed_rpm=(20, 80, 10), normal_force=(1, 60, 5), runs=300, seed=2, out=tmp_path)
    few = stickslip.ensemble(rig, speed_rpm=(20, 80, 10), normal_force=(1, 60, 5), runs=3, seed=2)
    pandas.testing.assert_frame_equal(made.runs.iloc[: 3 * 50], few.runs, check_exact=True)


def test_an_interrupted_run_keeps_its_rows() -> None:
    out, seconds = interrupted_after(
        1.0,
        """
        try:
            stickslip.Rig.reduced().simulate(speed_rpm=55, normal_force=50, stop=1e6, step=0.1)
        except stickslip.Interrupted as stopped:
            frame = stopped.partial.frame
            print(len(frame), frame["theta"].iloc[-1] > 0, stopped.partial.summary)
        """,
    )
    count, moves, summary = out.split()
    assert 10 < int(count) < 10_000_000 and (moves, summary) == ("True", "None")
    assert seconds < 2


def test_an_interrupted_diagnosis_leaves_nothing_half(tmp_path: pathlib.Path) -> None:
    out, seconds = interrupted_after(
        1.0,
        f"""
        try:
            for _ in range(100):
                stickslip.Case.from_directory({str(CASE)!r}).diagnose(out={str(tmp_path)!r})
        except stickslip.Interrupted as stopped:
            print(stopped)
        """,
    )
    assert "interrupted" in out
    assert seconds < 10
    for path in tmp_path.iterdir():
        assert not path.name.endswith(".partial"), path
    if "nothing was written" not in out:
        assert "finding.json" in out and (tmp_path / "finding.json").exists()


@pytest.mark.parametrize("program", [["-m", "stickslip"], None])
def test_the_program_ends_at_ctrl_c_as_the_other_does(program: list[str] | None, tmp_path: pathlib.Path) -> None:
    command = [sys.executable, *program] if program else [str(INSTALLED / "stickslip")]
    words = ["map", "model.toml", "--speed-rpm", "20:80:40", "--normal-force", "1:80:400", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [*command, *words], cwd=CASE, stderr=subprocess.PIPE, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    )
    time.sleep(2)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130, error
    assert "the same command goes on from there" in error


def test_a_forked_process_refuses_what_would_wait_for_ever() -> None:
    script = f"""
    import os, stickslip, sys
    stickslip.Case.from_directory({str(CASE)!r})
    child = os.fork()
    if child == 0:
        made = stickslip.map(stickslip.Rig.reduced(), speed_rpm=(40, 60, 3), normal_force=50, duration=5)
        try:
            stickslip.Case.from_directory({str(CASE)!r})
        except stickslip.InputError as error:
            os._exit(3 if "spawn" in str(error) and len(made.frame) == 3 else 4)
        os._exit(5)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """
    result = subprocess.run([sys.executable, "-W", "ignore", "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=60)
    assert result.stdout.strip() == "3", result.stdout + result.stderr


def test_a_score_goes_on_where_it_stopped(tmp_path: pathlib.Path) -> None:
    """Two copies of the case, of which the second answer is wrong."""
    cases = tmp_path / "cases"
    for name in ("case-1", "case-2"):
        shutil.copytree(CASE, cases / name)
    kinds = {"case-1": "unbalance", "case-2": "backlash"}
    answers = {name: {"kind": kind, "effects": {}} for name, kind in kinds.items()}
    (cases / "ANSWERS.json").write_text(json.dumps(answers))
    out = tmp_path / "out"
    first = stickslip.score(cases, out=out, progress=False)
    kept = {path: path.read_bytes() for path in out.glob("*/finding.json")}
    assert len(kept) == 2 and not first.is_passed and not first.failed
    begun = time.monotonic()
    again = stickslip.score(cases, out=out, progress=False)
    assert time.monotonic() - begun < 1
    assert again.frame.equals(first.frame) and again.markdown == first.markdown
    assert {path: path.read_bytes() for path in kept} == kept
    program = subprocess.run([str(INSTALLED / "stickslip"), "score", str(cases), "--out", str(out)], capture_output=True, text=True)
    assert (program.returncode, program.stdout) == (1, first.markdown)
