"""The practice cases of the reduced rig twice: natively, and with the exported rig as a foreign FMU. Are the names the same?

    python tests/diagnosis/own_rigs.py RECORDS OUT [CASE ...] [--programs target/release]

RECORDS has a directory for each case. Neither diagnosis sees ANSWERS.json; what was hidden is printed beside their names.
Each line has the time of the FMU's diagnosis; the last ones count.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]

# The rig has no input for a torque. Two effects whose equation is a number of theirs give its FMU parameters that act as such.
EFFECTS = """
[[effect]]
name = "disc_port"
title = "A torque from outside on the disc"
port = "disc.torque"
equation = "torque"
parameters.torque = { value = 0.0, unit = "N.m", description = "Torque" }

[[effect]]
name = "motor_port"
title = "A torque from outside on the gearbox output"
port = "motor.torque"
equation = "torque/8"
parameters.torque = { value = 0.0, unit = "N.m", description = "Torque" }
"""

PORTS = """[plant]
kind = "fmu"
path = "turn"

[[port]]
name = "disc"
input = "disc_port.torque"
position = "theta"
velocity = "theta_dot"
friction = "T_f"

[[port]]
name = "motor"
input = "motor_port.torque"
position = "theta3"
velocity = "theta3_dot"
measured_position = { column = "theta3", unit = "rad" }
measured_velocity = { column = "theta3_dot", unit = "rad/s" }

[inputs]
u = { column = "u", unit = "V", between = "held" }
N2 = { column = "N2", unit = "N", between = "held", may_be_offset = true }

[columns]
time = { column = "time", unit = "s" }
position = { column = "theta", unit = "rad" }
velocity = { column = "theta_dot", unit = "rad/s" }
load = { column = "N2", unit = "N" }

[measurement]
motion_low_pass = 25.0
compare_low_pass = 8.0
compare_rate = 50.0
edge = 0.5
standstill_speed = 0.2

[drifts]
parameters = ["motor.resistance"]

[parameters]
"""

# How well the nominal parameters are known, by the records' README.
UNCERTAIN = {
    "disc.inertia": ("kg.m2", 0.006),
    "shaft.stiffness": ("N.m/rad", 0.02),
    "shaft.damping": ("N.m.s/rad", 0.06),
    "motor.resistance": ("Ohm", 0.02),
    "motor.torque_constant": ("N.m/A", 0.02),
    "motor.back_emf_constant": ("V.s/rad", 0.01),
    "motor.coulomb_torque": ("N.m", 0.04),
    "contact.mu_c": ("1", 0.02),
    "contact.mu_s": ("1", 0.02),
    "contact.mu": ("1", 0.02),
    "contact.a1": ("1", 0.02),
    "contact.a2": ("1", 0.02),
}

# What the rig's own catalogue calls an effect of the FMU.
NATIVE = {
    "coulomb_friction_at_disc": "bearing_friction",
    "normal_force_wobble_at_disc": "normal_force_wobble",
    "acceleration_hysteresis_at_disc": "acceleration_hysteresis",
    "stribeck_at_disc": "stribeck",
    "unbalance_at_disc": "unbalance",
    "viscous_drag_at_disc": "viscous_drag",
    "quadratic_drag_at_disc": "quadratic_drag",
    "viscous_drag_at_motor": "motor_viscous",
    "friction_wear_at_disc": "friction_wear",
    "load_exponent_at_disc": "load_exponent",
    "sensor_delay_at_disc": "sensor_delay",
    "hardening_between_disc_and_motor": "shaft_hardening",
    "backlash_between_disc_and_motor": "backlash",
    "N2_offset": "load_cell_bias",
    "motor_resistance_drift": "resistance_drift",
}


def ports(model):
    """The ports file of a rig with this model file."""
    lines = []
    for name, (unit, share) in UNCERTAIN.items():
        section, key = name.split(".")
        if key in model[section]:
            value = float(model[section][key])
            lines.append(f'"{name}" = {{ value = {value!r}, unit = "{unit}", relative_uncertainty = {share} }}')
    return PORTS + "\n".join(lines) + "\n"


def diagnosed(programs, out, *case):
    """What `stickslip diagnose` finds: verdict, names, rivals, and its time [s]."""
    begun = time.monotonic()
    done = subprocess.run([programs / "stickslip", "diagnose", *case, "--out", out], capture_output=True, text=True)
    took = time.monotonic() - begun
    if done.returncode > 1:
        raise SystemExit(f"{out}: {done.stderr}")
    found = json.loads((out / "finding.json").read_text())
    return found["verdict"], [effect["name"] for effect in found["effects"]], found["alternatives"], took


def exported(programs, case, folder):
    """The rig of a case as an FMU with its ports file."""
    text = (case / "model.toml").read_text()
    (folder / "rig.toml").write_text(text + EFFECTS)
    (folder / "ports.toml").write_text(ports(tomllib.loads(text)))
    build = [programs / "build-fmu", folder / "rig.toml", "--out", folder, "--fmi", "3", "--library", programs / "libstickslip.so"]
    subprocess.run(build, check=True, capture_output=True)
    return folder / "ReducedRig.fmi3.fmu", folder / "ports.toml"


def main():
    """Diagnoses each case twice."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("records", type=pathlib.Path)
    arguments.add_argument("out", type=pathlib.Path)
    arguments.add_argument("cases", nargs="*")
    arguments.add_argument("--programs", type=pathlib.Path, default=ROOT / "target" / "release")
    given = arguments.parse_args()
    answers = json.loads((given.records / "ANSWERS.json").read_text())
    same, wrong, times = 0, 0, []
    for name in given.cases or sorted(answers):
        case, folder = given.records / name, given.out / name
        folder.mkdir(parents=True, exist_ok=True)
        native, own, _, _ = diagnosed(given.programs, folder / "native", case)
        fmu, file = exported(given.programs, case, folder)
        runs = sorted(case.glob("run-*.csv"))
        held_out = case / "held-out.csv"
        foreign = ["--model", fmu, "--ports", file, "--records", *runs, "--held-out", held_out]
        verdict, names, rivals, took = diagnosed(given.programs, folder / "fmu", *foreign)
        translated = {NATIVE.get(effect, effect) for effect in names}
        # A stiction that the model lacks is a Stribeck law of no width to whoever sees the moving contact alone.
        known = {"stribeck" if effect == "stiction" else effect for effect in own}
        is_same, is_wrong = translated == known, not translated <= known
        same, wrong = same + is_same, wrong + is_wrong
        times.append(took)
        word = "same" if is_same else "wrong" if is_wrong else "less"
        said = f"{verdict}: {', '.join(names)}" + (f" (or {', '.join(rivals)})" if rivals else "")
        print(f"{name} | {answers[name]['kind']} | {native}: {', '.join(own)} | {said} | {word} | {took:.0f} s", flush=True)
    print(f"{same} of {len(times)} as natively, {wrong} with a name that the native diagnosis does not give")
    print(f"time a case: median {statistics.median(times):.0f} s, longest {max(times):.0f} s")


if __name__ == "__main__":
    main()
