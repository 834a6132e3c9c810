"""Results are those of the programs bit for bit, and the package's programs are those that cargo builds."""

from __future__ import annotations

import json
import pathlib
import re
import zipfile

import numpy
import pandas
import pytest
from conftest import BUILT, CASE, INSTALLED, LIBRARY, MODELS, ROOT, run, table

import stickslip


def test_a_run(tmp_path: pathlib.Path) -> None:
    model = MODELS / "reduced-rig.toml"
    result = run(BUILT / "stickslip", "simulate", model, "--speed-rpm", 55, "--normal-force", 50, "--out", tmp_path)
    assert result.returncode == 0, result.stderr
    expected = table(tmp_path / "result.csv")
    made = stickslip.Rig.from_toml(model).simulate(speed_rpm=55, normal_force=50)
    pandas.testing.assert_frame_equal(made.frame, expected, check_exact=True)
    assert made.summary is not None and made.summary.frequency is not None
    assert re.search(rf"frequency +{made.summary.frequency:.4f} Hz", result.stdout)
    assert f"switches        {made.summary.switches} " in result.stdout
    assert len(made.events) == made.summary.switches


def test_a_run_under_a_record_with_other_numbers(tmp_path: pathlib.Path, records: dict[str, pandas.DataFrame]) -> None:
    model, record = CASE / "model.toml", CASE / "run-a.csv"
    words = ["--inputs", record, "--set", "contact.mu_s=0.25", "--set", "disc.inertia=0.015", "--step", 0.003]
    result = run(BUILT / "stickslip", "simulate", model, *words, "--out", tmp_path)
    assert result.returncode == 0, result.stderr
    rig = stickslip.Rig.from_toml(model).with_({"contact.mu_s": 0.25, "disc.inertia": 0.015})
    for inputs in (records["run-a"], record, str(record)):
        made = rig.simulate(inputs=inputs, step=0.003)
        pandas.testing.assert_frame_equal(made.frame, table(tmp_path / "result.csv"), check_exact=True)


def test_the_full_rig(tmp_path: pathlib.Path) -> None:
    model = MODELS / "full-rig.toml"
    words = ["--speed-rpm", 40, "--normal-force", 20, "--normal-force-1", 30, "--duration", 10, "--out", tmp_path]
    assert run(BUILT / "stickslip", "simulate", model, *words).returncode == 0
    made = stickslip.Rig.from_toml(model).simulate(speed_rpm=40, normal_force=20, normal_force_1=30, stop=10)
    pandas.testing.assert_frame_equal(made.frame, table(tmp_path / "result.csv"), check_exact=True)


def test_a_map(tmp_path: pathlib.Path) -> None:
    model = MODELS / "reduced-rig.toml"
    words = ["--speed-rpm", "20:60:5", "--normal-force", "0:60:4", "--duration", 20, "--out", tmp_path / "program"]
    assert run(BUILT / "stickslip", "map", model, *words).returncode == 0
    made = stickslip.map(
        stickslip.Rig.from_toml(model), speed_rpm=(20, 60, 5), normal_force=(0, 60, 4), duration=20, out=tmp_path / "package"
    )
    assert (tmp_path / "package/map.csv").read_bytes() == (tmp_path / "program/map.csv").read_bytes()
    expected = pandas.read_csv(tmp_path / "program/map.csv")
    assert list(made.frame) == list(expected)
    for name in expected:
        assert made.frame[name].equals(expected[name].astype(made.frame[name].dtype)), name


def test_extrema_over_one_quantity(tmp_path: pathlib.Path) -> None:
    rig = stickslip.Rig.reduced()
    made = stickslip.map(rig, speed_rpm=55, normal_force=(10, 50, 3), duration=30, out=tmp_path)
    expected = pandas.read_csv(tmp_path / "extrema.csv")
    assert len(expected) > 20
    assert made.extrema.equals(expected)


def test_an_ensemble(tmp_path: pathlib.Path) -> None:
    model = MODELS / "reduced-rig.toml"
    words = ["--speed-rpm", 55, "--normal-force", "0:60:4", "--runs", 20, "--seed", 3, "--uncertain", "contact.mu_s=0.1"]
    words += ["--duration", 20, "--out", tmp_path / "program"]
    assert run(BUILT / "stickslip", "ensemble", model, *words).returncode == 0
    made = stickslip.ensemble(
        stickslip.Rig.from_toml(model),
        speed_rpm=55,
        normal_force=(0, 60, 4),
        runs=20,
        seed=3,
        uncertain={"contact.mu_s": 0.1},
        duration=20,
        out=tmp_path / "package",
    )
    tables = {"ensemble": made.frame, "runs": made.runs, "rigs": made.rigs.reset_index()}
    for name, frame in tables.items():
        expected = tmp_path / f"program/{name}.csv"
        assert (tmp_path / f"package/{name}.csv").read_bytes() == expected.read_bytes()
        pandas.testing.assert_frame_equal(frame, pandas.read_csv(expected), check_exact=True)
    assert made.figure().axes and "20 rigs" in repr(made)


def comparable(text: str) -> object:
    """A finding but for the time it took."""
    return {**json.loads(text), "seconds": None}


@pytest.fixture(scope="module")
def program_s(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """What the program makes of the case."""
    out = tmp_path_factory.mktemp("program")
    result = run(BUILT / "stickslip", "diagnose", CASE, "--out", out)
    assert result.returncode == 0, result.stderr
    (out / "screen.txt").write_text(result.stdout)
    return out


def test_a_diagnosis_of_files(program_s: pathlib.Path, tmp_path: pathlib.Path) -> None:
    # With the library that the program packs; the wheel's own was linked for older systems.
    finding = stickslip.Case.from_directory(CASE).diagnose(out=tmp_path, library=LIBRARY)
    assert comparable(finding.to_json()) == comparable((program_s / "finding.json").read_text())
    for name in ("model.amended.toml", "ReducedRig.fmi2.fmu", "ReducedRig.fmi3.fmu"):
        assert (tmp_path / name).read_bytes() == (program_s / name).read_bytes(), name
    assert (program_s / "screen.txt").read_text().startswith(str(finding))
    assert finding.is_settled is True


def test_a_diagnosis_of_tables(program_s: pathlib.Path, records: dict[str, pandas.DataFrame]) -> None:
    """But for the names of the records nothing is another."""
    rig = stickslip.Rig.from_toml(CASE / "model.toml")
    learned = {str(CASE / f"{name}.csv"): records[name] for name in ("run-a", "run-b")}
    case = stickslip.Case(rig, learned, held_out=records["held-out"], name=CASE.name)
    finding = case.diagnose()
    assert comparable(finding.to_json()) == comparable((program_s / "finding.json").read_text())
    assert finding.amended.to_toml() == (program_s / "model.amended.toml").read_text()


def test_columns_in_other_units_are_converted_as_the_model_file_does(
    program_s: pathlib.Path, records: dict[str, pandas.DataFrame]
) -> None:
    def in_rpm(record: pandas.DataFrame) -> pandas.DataFrame:
        speed = record["theta_dot"] * 30 / numpy.pi
        return record.drop(columns="theta_dot").assign(**{"disc speed": speed})

    rig = stickslip.Rig.from_toml(CASE / "model.toml")
    learned = [in_rpm(records[name]) for name in ("run-a", "run-b")]
    case = stickslip.Case(rig, learned, held_out=in_rpm(records["held-out"]), columns={"theta_dot": ("disc speed", "rpm")})
    assert any("converted from rpm to rad/s" in note for note in case.notes)
    finding = case.diagnose()
    expected = json.loads((program_s / "finding.json").read_text())["effects"][0]["parameters"]["unbal_T"]["value"]
    assert finding.verdict == "named"
    assert abs(finding.effects[0].parameters["unbal_T"].value / expected - 1) < 1e-6


def test_fmus(tmp_path: pathlib.Path) -> None:
    model = MODELS / "full-rig.toml"
    assert run(INSTALLED / "build-fmu", model, "--out", tmp_path / "program").returncode == 0
    built = stickslip.Rig.from_toml(model).build_fmu(tmp_path / "package")
    assert [path.name for path in built] == ["FullRig.fmi2.fmu", "FullRig.fmi3.fmu"]
    for path in built:
        assert path.read_bytes() == (tmp_path / "program" / path.name).read_bytes()
    (only,) = stickslip.Rig.from_toml(model).build_fmu(tmp_path / "one", fmi=3)
    assert only.read_bytes() == built[1].read_bytes()


def test_fmus_of_other_platforms_need_no_compiler(tmp_path: pathlib.Path) -> None:
    (path,) = stickslip.Rig.reduced().build_fmu(tmp_path, platforms=["linux64"], fmi=2)
    with zipfile.ZipFile(path) as archive:
        assert "binaries/linux64/ReducedRig.so" in archive.namelist()


@pytest.mark.parametrize(
    ("program", "words", "code"),
    [
        ("stickslip", ["--version"], 0),
        ("stickslip", ["info", MODELS / "reduced-rig.toml"], 0),
        ("stickslip", ["experiment", "list"], 0),
        ("stickslip", ["simulate", "absent.toml", "--speed-rpm", 55, "--normal-force", 50, "--out", "out"], 2),
        ("stickslip", ["diagnos"], 2),
        ("build-fmu", ["--version"], 0),
        ("build-fmu", ["absent.toml", "--out", "out"], 2),
        ("build-fmu", ["check", "absent.fmu"], 2),
    ],
)
def test_the_programs_say_and_return_the_same(program: str, words: list[object], code: int) -> None:
    package, cargo = run(INSTALLED / program, *words), run(BUILT / program, *words)
    assert (package.returncode, package.stdout, package.stderr) == (cargo.returncode, cargo.stdout, cargo.stderr)
    assert package.returncode == code


def test_a_check_that_says_no_is_exit_code_1(tmp_path: pathlib.Path) -> None:
    (path,) = stickslip.Rig.reduced().build_fmu(tmp_path, fmi=2)
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    spoiled = tmp_path / "spoiled.fmu"
    with zipfile.ZipFile(spoiled, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, content.replace(b'unit="V"', b'unit="volt"'))
    assert run(INSTALLED / "build-fmu", "check", path).returncode == 0
    assert run(INSTALLED / "build-fmu", "check", spoiled).returncode == 1


def swing(amplitude: float) -> pandas.DataFrame:
    """A pendulum with dry friction beside viscous drag, from rest at an amplitude [rad]; its angle as an encoder reads it."""
    step, square, viscous, dry = 0.002, 64.0, 0.05, 0.35

    def rate(angle: float, velocity: float) -> tuple[float, float]:
        return velocity, -square * numpy.sin(angle) - viscous * velocity - dry * numpy.sign(velocity)

    angle, velocity, angles = amplitude, 0.0, []
    for _ in range(6001):
        angles.append(angle)
        first = rate(angle, velocity)
        middle = rate(angle + 0.5 * step * first[0], velocity + 0.5 * step * first[1])
        angle, velocity = angle + step * middle[0], velocity + step * middle[1]
    times = pandas.Index(numpy.arange(6001) * step, name="t_s")
    encoder = 2 * numpy.pi / 20000
    return pandas.DataFrame({"theta_rad": numpy.floor((numpy.array(angles) + numpy.pi) / encoder) * encoder}, index=times)


def test_a_small_plant(tmp_path: pathlib.Path) -> None:
    model = ROOT / "docs/examples/pendulum.toml"
    directory = tmp_path / "pendulum"
    directory.mkdir()
    (directory / "model.toml").write_bytes(model.read_bytes())
    learned, held_out = swing(1.2), swing(0.9)
    learned.to_csv(directory / "run-a.csv")
    held_out.to_csv(directory / "held-out.csv")
    result = run(BUILT / "stickslip", "diagnose", directory, "--out", tmp_path / "program")
    assert result.returncode == 0, result.stdout + result.stderr
    finding = stickslip.Case(model, {"run-a.csv": learned}, held_out=held_out, name="pendulum").diagnose(out=tmp_path / "package")
    assert comparable(finding.to_json()) == comparable((tmp_path / "program/finding.json").read_text())
    assert str(finding) == result.stdout
    assert finding.verdict == "named" and finding.held_out == []
    assert [path.name for path in finding.fmus] == ["Pendulum.fmi2.fmu", "Pendulum.fmi3.fmu"]
    assert [effect.name for effect in finding.effects] == ["coulomb_friction"]
