"""The examples for Python users run and show what they say; a study survives killed workers and goes on where it was."""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import nbformat
import numpy
import pandas
import psutil
import pytest
from fmpy.util import read_ref_opt_file
from nbclient import NotebookClient

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "target" / "release"
EXAMPLES = ROOT / "docs" / "examples" / "python"
MODEL = ROOT / "modelDescription" / "reduced-rig.toml"
CASE = ROOT / "crates" / "workbench" / "tests" / "data" / "unbalance"
OUT = ROOT / "out" / "examples"  # kept: CI's pictures
GRID = ["--speed-rpm", "25", "60", "8", "--normal-force", "10", "50", "5", "--stop", "30"]

sys.path.insert(0, str(EXAMPLES))
import rig  # noqa: E402  the examples' own module


def python(script, *arguments):
    """What an example prints."""
    command = [sys.executable, EXAMPLES / f"{script}.py", *arguments]
    result = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def build(model, folder, version):
    subprocess.run([PROGRAMS / "build-fmu", model, "--fmi", version, "--out", folder], check=True)
    return folder / f"ReducedRig.fmi{version}.fmu"


@pytest.fixture(scope="session", params=["2", "3"])
def fmu(request):
    return build(ROOT / "modelDescription" / "reduced-rig.toml", OUT, request.param)


def is_picture(path):
    return path.read_bytes().startswith(b"\x89PNG")


def test_a_run_is_plotted_and_kept():
    said = python("run_and_plot", MODEL, "--out", OUT)
    run = pandas.read_csv(OUT / "run.csv", index_col="time")
    assert len(run) == 6001 and is_picture(OUT / "run.png")
    late = run["theta_dot"][run.index > 40]
    assert late.min() < 1e-9 and 12.6 < late.max() < 12.8
    assert len(pandas.read_csv(OUT / "events.csv")) == 88
    assert f"stick_slip: disc D2 between 0.000 and {late.max():.3f} rad/s" in said


def test_parameters_change_the_motion():
    python("change_parameters", MODEL, "contact.mu_s", "0.13", "0.2", "--out", OUT)
    runs = pandas.read_csv(OUT / "parameters.csv", index_col="time")
    late = runs[runs.index > 10]
    assert late["0.13"].min() > 4.0 and late["0.2"].min() < 1e-9
    assert is_picture(OUT / "parameters.png")


def test_a_case_is_diagnosed():
    folder = OUT / "diagnosis"
    records = [CASE / "run-a.csv", f"{CASE / 'run-b.csv'}@0:10", "--held-out", CASE / "held-out.csv"]
    said = python("diagnose", CASE / "model.toml", *records, "--out", folder)
    assert "Missing: unbalance" in said
    assert json.loads((folder / "finding.json").read_text())["verdict"] == "named"
    assert is_picture(folder / "held-out.png") and is_picture(folder / "candidates.png")
    assert len(list(folder.glob("*.fmu"))) == 2


MISTAKES = [
    ("run_and_plot", "absent.toml", ["argument model: absent.toml: cannot be read: No such file"]),
    ("run_and_plot", "text.fmu", ["argument model: text.fmu"]),
    ("run_and_plot", "controller.toml", ["argument model: controller.toml: is a controller; a rig is needed"]),
    ("run_and_plot", "rig.toml --normal-force -1", ["argument --normal-force: -1 N is below zero"]),
    ("run_and_plot", "rig.toml --stop 0", ["argument --stop: 0 is not above zero"]),
    ("run_and_plot", "rig.toml --stop 0.001", ["step 0.01: is longer than the run"]),
    ("run_and_plot", "rig.toml --out text.fmu", ["the folder text.fmu cannot be made: File exists"]),
    ("change_parameters", "rig.toml contact.mu 0.1", ["has no parameter `contact.mu`", "contact.mu_s"]),
    ("change_parameters", "rig.toml contact.mu_s fast", ["argument values: invalid number value: 'fast'"]),
    ("change_parameters", "rig.toml contact.mu_s 0.01", ["mu_s = 0.01", "mu_c = 0.12"]),
    ("diagnose", "rig.toml absent.csv", ["absent.csv: cannot be read"]),
    ("diagnose", "rig.toml columns.csv --held-out words.csv", ["words.csv line 3, column `N2`: `strong` is not a number"]),
    ("validate", "record.csv absent.fmu", ["argument fmus: absent.fmu cannot be read as an FMU"]),
    ("validate", "record.csv text.fmu", ["argument fmus: text.fmu cannot be read as an FMU"]),
    ("validate", "record.csv controller.fmu", ["controller.fmu is no FMU of a rig: it has no variable N2"]),
    ("validate", "absent.csv rig.fmu", ["argument record: absent.csv cannot be read", "No such file"]),
    ("validate", "columns.csv rig.fmu", ["columns.csv has no column N2, theta", "it has u, n2"]),
    ("validate", "words.csv rig.fmu", ["words.csv: column N2 has something that is no finite number"]),
    ("validate", "times.csv rig.fmu", ["times.csv: times must rise by the same interval"]),
    ("study", "rig.fmu --speed-rpm 20 70 2.5 --normal-force 10 70 3", ["--speed-rpm: COUNT 2.5 is no whole number"]),
    ("study", "rig.fmu --speed-rpm 20 70 3 --normal-force -10 70 3", ["--normal-force: -10 N is below zero"]),
    ("study", "rig.fmu --speed-rpm 20 70 3 --normal-force 10 70 3 --workers 0", ["--workers: 0 is not 1 or more"]),
]


@pytest.fixture(scope="session")
def bench(tmp_path_factory):
    """A folder with a rig, a controller and files that are wrong in one thing each."""
    folder = tmp_path_factory.mktemp("mistakes")
    for model, name in [("reduced-rig", "rig"), ("soft-torque", "controller")]:
        made = subprocess.run(
            [PROGRAMS / "build-fmu", ROOT / "modelDescription" / f"{model}.toml", "--fmi", "2", "--out", folder],
            check=True, capture_output=True, text=True,
        )
        pathlib.Path(made.stdout.split(" (")[0]).rename(folder / f"{name}.fmu")
        shutil.copy(ROOT / "modelDescription" / f"{model}.toml", folder / f"{name}.toml")
    shutil.copy(CASE / "held-out.csv", folder / "record.csv")
    (folder / "text.fmu").write_text("no archive")
    head = "time,u,N2,theta,theta_dot,theta3,theta3_dot\n"
    (folder / "columns.csv").write_text("time,u,n2\n0,1,2\n1,1,2\n")
    (folder / "words.csv").write_text(head + "0,1,2,0,0,0,0\n1,1,strong,0,0,0,0\n")
    (folder / "times.csv").write_text(head + "0,1,2,0,0,0,0\n1,1,2,0,0,0,0\n1.5,1,2,0,0,0,0\n")
    return folder


@pytest.mark.parametrize("script, arguments, expected", MISTAKES)
def test_a_mistake_is_named_with_its_remedy(bench, script, arguments, expected):
    words = arguments.split() + ([] if "--out" in arguments else ["--out", "out"])
    result = subprocess.run(
        [sys.executable, EXAMPLES / f"{script}.py", *words], capture_output=True, text=True, cwd=bench, timeout=120
    )
    assert result.returncode == 2, result.stdout + result.stderr
    for part in expected:
        assert part in result.stdout + result.stderr, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    assert not list((bench / "out").glob("*.csv"))


def test_pandas_in_and_out_hold_inputs_between_rows(fmu):
    inputs = pandas.DataFrame({"u": [3.0, 1.0, 1.0], "N2": [20.0, 20.0, 20.0]}, index=[0.0, 1.0, 2.0])
    stepped = rig.simulate(fmu, 2.0, inputs=inputs)
    first = rig.simulate(fmu, 1.0, u=3.0, N2=20.0)
    assert list(stepped.columns) == rig.OUTPUTS and stepped.index.name == "time"
    until = stepped.loc[:1.0]
    assert numpy.abs(until.to_numpy() - first.to_numpy()).max() < 1e-9
    assert stepped["theta3_dot"].iloc[-1] < 0.8 * first["theta3_dot"].iloc[-1]


def test_measures_tell_the_right_model_from_a_wrong_one(fmu, tmp_path):
    """The record is the right model's own run: it agrees with itself, a model with other friction does not."""
    version = fmu.name.split(".")[1][-1]
    voltage = rig.voltage_for(fmu, 55)
    record = rig.simulate(fmu, 10.0, u=voltage, N2=50.0)[["theta", "theta_dot", "theta3", "theta3_dot"]]
    record.insert(0, "u", voltage)
    record.insert(1, "N2", 50.0)
    record = record[record.index >= 2.0]
    record.to_csv(tmp_path / "record.csv")
    wrong = tmp_path / "wrong.toml"
    text = (ROOT / "modelDescription" / "reduced-rig.toml").read_text()
    changed = re.sub(r"(?m)^(mu_s = \{ value = )[0-9.]+", r"\g<1>0.16", text)
    assert changed != text
    wrong.write_text(changed)
    other = build(wrong, tmp_path / "wrong", version)
    python("validate", tmp_path / "record.csv", fmu, other, "--out", tmp_path)
    table = pandas.read_csv(tmp_path / "measures.csv", index_col=["FMU", "runs"])
    right, bad = table.loc[str(fmu), "windows"], table.loc[str(other), "windows"]
    print(table)
    assert right["rmse"] < 0.02 and right["pc"] > 0.9999
    assert bad["rmse"] > 10 * right["rmse"]
    assert is_picture(tmp_path / "validation.png")


@pytest.mark.parametrize("version, folder", [("2.0", "linux64"), ("3.0", "x86_64-linux")])
def test_an_importer_meets_the_cross_check_s_reference(tmp_path, version, folder):
    model = ROOT / "modelDescription" / "reduced-rig.toml"
    command = [PROGRAMS / "stickslip", "cross-check", model, "--speed-rpm", "55", "--normal-force", "50"]
    subprocess.run([*command, "--out", tmp_path], check=True)
    (place,) = (tmp_path / version / "cs" / folder / "stickslip").glob("*/ReducedRig")
    options = read_ref_opt_file(place / "ReducedRig_ref.opt")
    inputs = pandas.read_csv(place / "ReducedRig_in.csv", index_col="time")
    reference = pandas.read_csv(place / "ReducedRig_ref.csv", index_col="time")
    assert (options["StartTime"], options["StopTime"]) == (0.0, 60.0) == (inputs.index[0], inputs.index[-1])
    run = rig.simulate(place / "ReducedRig.fmu", options["StopTime"], options["StepSize"], inputs, list(reference.columns))
    assert len(reference) == len(run) == 6001 and reference["theta"].iloc[-1] > 300
    assert numpy.abs(run.to_numpy() - reference.to_numpy()).max() < 1e-9


def heed_interrupts():
    """Tests that run in a shell's background ignore interrupts, and so would what they start."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def study(folder, fmu, *more):
    # Runs long enough for a study to be disturbed while there is work.
    command = [sys.executable, EXAMPLES / "study.py", fmu, *GRID, "--stop", "300", "--out", folder, *more]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heed_interrupts)


def finished(process):
    stdout, stderr = process.communicate(timeout=240)
    assert process.returncode == 0, stdout + stderr
    return stderr


def rows(folder):
    return pandas.read_csv(folder / "study.csv").sort_values(["speed_rpm", "normal_force"]).reset_index(drop=True)


def wait_for_rows(folder, count):
    for _ in range(6000):
        if (folder / "study.csv").exists() and len((folder / "study.csv").read_text().splitlines()) > count:
            return
        time.sleep(0.02)
    raise AssertionError("the study has not begun")


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """The study's table when nothing happens to it, and its progress."""
    fmu = build(ROOT / "modelDescription" / "reduced-rig.toml", OUT, "3")
    folder = tmp_path_factory.mktemp("study")
    progress = finished(study(folder, fmu))
    return fmu, rows(folder), progress


def test_a_study_shows_progress_and_finds_both_kinds_of_motion(undisturbed):
    _, table, progress = undisturbed
    assert len(table) == 40 and not table.duplicated(["speed_rpm", "normal_force"]).any()
    assert 0 < (table["stuck_share"] > 0).sum() < 40
    assert "40/40" in progress


def test_a_study_survives_a_killed_worker(undisturbed, tmp_path):
    fmu, expected, _ = undisturbed
    process = study(tmp_path, fmu)
    wait_for_rows(tmp_path, 3)
    workers = [child for child in psutil.Process(process.pid).children(recursive=True)
               if any("spawn_main" in word for word in child.cmdline())]
    assert len(workers) >= 2, "the workers of the local cluster"
    os.kill(workers[0].pid, signal.SIGKILL)
    killed_at = len(rows(tmp_path))
    finished(process)
    assert killed_at < 40, "the worker was killed while there was work"
    pandas.testing.assert_frame_equal(rows(tmp_path), expected)


def test_a_study_that_was_ended_goes_on_where_it_was(undisturbed, tmp_path):
    fmu, expected, _ = undisturbed
    process = study(tmp_path, fmu)
    wait_for_rows(tmp_path, 3)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    before = rows(tmp_path)
    assert 3 <= len(before) < 40
    finished(study(tmp_path, fmu))
    pandas.testing.assert_frame_equal(rows(tmp_path), expected)
    # Rows of other runs would be kept as if they were of these.
    other = study(tmp_path, fmu, "--stop", "299")
    assert "has the study of another FMU or another --stop" in other.communicate(timeout=60)[1]
    assert other.returncode == 2


def test_the_same_study_on_a_scheduler_by_its_address(undisturbed, tmp_path):
    """`dask scheduler` and `dask worker` as on any cluster; the worker has a folder of its own."""
    fmu, expected, _ = undisturbed
    address = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    helpers = [
        subprocess.Popen([*dask, "scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", address], cwd=tmp_path),
        subprocess.Popen([*dask, "worker", "--scheduler-file", address, "--nworkers", "2", "--no-dashboard"], cwd=tmp_path),
    ]
    try:
        for _ in range(300):
            if address.exists():
                break
            time.sleep(0.1)
        scheduler = json.loads(address.read_text())["address"]
        finished(study(tmp_path / "out", fmu, "--scheduler", scheduler))
    finally:
        for helper in helpers:
            helper.terminate()
            helper.wait(timeout=30)
    pandas.testing.assert_frame_equal(rows(tmp_path / "out"), expected)


def kinds(notebook):
    """What each cell of a notebook shows: kinds of data, or the name of a stream."""
    return [
        [sorted(output.get("data", {})) or output.get("name", output.output_type) for output in cell.get("outputs", [])]
        for cell in notebook.cells
    ]


def test_the_notebook_tells_its_story_and_is_stored_with_what_it_shows():
    stored = nbformat.read(EXAMPLES / "story.ipynb", as_version=4)
    notebook = nbformat.from_dict(json.loads(json.dumps(stored)))
    NotebookClient(notebook, timeout=200, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    for cell in notebook.cells:
        cell.metadata.clear()  # when it was executed
    nbformat.write(notebook, OUT / "story.ipynb")
    shown = [kind for cell in kinds(notebook) for kind in cell]
    assert sum("image/png" in kind for kind in shown) == 3 and sum("text/html" in kind for kind in shown) >= 6
    again = f"cp {(OUT / 'story.ipynb').relative_to(ROOT)} docs/examples/python/"
    assert kinds(stored) == kinds(notebook), f"the notebook was changed and not executed since: {again}"
