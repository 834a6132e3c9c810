"""What all closed-loop examples share: the FMUs, the conditions, the run without controller, table and picture."""

import argparse
import csv
import math
import pathlib
import subprocess
import sys

import fmpy
import matplotlib
import numpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  the backend comes first

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD_FMU = ROOT / "target" / "release" / "build-fmu"
SPEED = 55 * 2 * math.pi / 60  # wanted speed of the gearbox output, rad/s
NORMAL_FORCE = 50.0  # of the pin on disc D2, N
STEP = 0.001  # communication step, s
STOP = 20.0  # s


def folder():
    """The folder for the results, from the command line: --out DIR."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "closed-loop")
    out = parser.parse_args().out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    return out


def build(model, out, *options):
    """Runs build-fmu on a model file of the project; returns what it wrote."""
    if not BUILD_FMU.exists():
        sys.exit(f"{BUILD_FMU} is missing: cargo build --release --package stickslip --package build-fmu")
    command = [BUILD_FMU, *options, ROOT / "modelDescription" / f"{model}.toml", "--out", out]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    return [pathlib.Path(line.split(" (")[0]) for line in lines]


def fmus(version, out):
    """Paths of the rig and the soft-torque controller for FMI `version`, 2 or 3."""
    return [build(model, out, "--fmi", str(version))[0] for model in ("reduced-rig", "soft-torque")]


def constant_voltage(rig):
    """Times and velocities of disc D2 without controller, at the voltage for the wanted speed."""
    variables = fmpy.read_model_description(str(rig)).modelVariables
    value = {v.name: float(v.start) for v in variables if "." in v.name}
    motor_speed = value["gearbox.ratio"] * SPEED
    torque = value["motor.viscous_damping"] * motor_speed + value["motor.coulomb_torque"]
    voltage = (
        value["motor.resistance"] * torque / value["motor.torque_constant"]
        + value["motor.back_emf_constant"] * motor_speed
    )
    result = fmpy.simulate_fmu(
        str(rig),
        stop_time=STOP,
        output_interval=0.01,
        start_values={"u": voltage, "N2": NORMAL_FORCE},
        output=["theta_dot"],
    )
    return result["time"], result["theta_dot"]


def save(out, name, title, without, runs):
    """Writes NAME.csv with the runs {label: velocities at the communication points} and NAME.png with all curves."""
    velocities = list(runs.values())
    times = [STEP * (index + 1) for index in range(len(velocities[0]))]
    with open(out / f"{name}.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *runs])
        writer.writerows(zip(times, *velocities))
    figure, axes = pyplot.subplots(figsize=(9, 4.4), layout="constrained")
    axes.plot(*without, color="0.6", label="constant voltage")
    for (label, velocity), style in zip(runs.items(), ("-", "--", ":", "-.")):
        axes.plot(times, velocity, style, label=label)
    axes.set(title=title, xlabel="time [s]", ylabel="velocity of disc D2 [rad/s]")
    figure.legend(loc="outside lower center", ncols=5)
    figure.savefig(out / f"{name}.png", dpi=120)
    late = {label: numpy.asarray(velocity)[-len(velocity) // 3 :] for label, velocity in runs.items()}
    for label, velocity in late.items():
        print(f"{label}: disc D2 between {velocity.min():.4f} and {velocity.max():.4f} rad/s in the last third")
    print(out / f"{name}.png")
