"""The practice cases of the reduced rig with the exported rig as a foreign FMU: is what was hidden named, and nothing else?

    python tests/diagnosis/own_rigs.py RECORDS OUT [CASE ...] [--programs target/release]

RECORDS has a directory for each case. The diagnosis does not see ANSWERS.json. The script ends with 1 if a name is wrong.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]

# The rig has no input for a torque. An effect whose equation is a number of its own gives its FMU a parameter that acts as one.
EFFECTS = """
[[effect]]
name = "disc_port"
title = "A torque from outside on the disc"
port = "disc.torque"
equation = "torque"
parameters.torque = { value = 0.0, unit = "N.m", description = "Torque" }
"""

PORTS = """[plant]
kind = "fmu"
path = "turn"

[port]
input = "disc_port.torque"
position = "theta"
velocity = "theta_dot"
load = { variable = "N2", factor = RADIUS }

[inputs]
u = { column = "u", unit = "V", between = "held" }
N2 = { column = "N2", unit = "N", between = "held", may_be_offset = true }

[columns]
time = { column = "time", unit = "s" }
position = { column = "theta", unit = "rad" }
velocity = { column = "theta_dot", unit = "rad/s" }

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

# What an FMU's diagnosis calls a hidden effect, where the names differ. A stiction that the model lacks is a Stribeck law of no width to
# whoever sees the moving contact alone.
NAMES = {
    "bearing_friction": "coulomb_friction",
    "stiction": "stribeck",
    "load_cell_bias": "N2_offset",
    "normal_force_wobble": "external_load_wobble",
    "friction_wear": "external_load_wear",
    "resistance_drift": "motor_resistance_drift",
}
# What is around a hidden effect's name in ANSWERS.json.
CIRCUMSTANCES = ("_braked", "_no_brake", "_gauss", "_c")


def hidden(kind):
    """The names that are right for a kind of ANSWERS.json."""
    for word in CIRCUMSTANCES:
        kind = kind.removesuffix(word)
    if kind == "wobble_and_bearing":
        return {"external_load_wobble", "coulomb_friction"}
    return set() if kind == "none" else {NAMES.get(kind, kind)}


def ports(model):
    """The ports file of a rig with this model file."""
    lines = []
    for name, (unit, share) in UNCERTAIN.items():
        section, key = name.split(".")
        if key in model[section]:
            value = float(model[section][key])
            lines.append(f'"{name}" = {{ value = {value!r}, unit = "{unit}", relative_uncertainty = {share} }}')
    return PORTS.replace("RADIUS", repr(model["contact"]["radius"])) + "\n".join(lines) + "\n"


def exported(programs, case, folder):
    """The rig of a case as an FMU with its ports file."""
    text = (case / "model.toml").read_text()
    (folder / "rig.toml").write_text(text + EFFECTS)
    (folder / "ports.toml").write_text(ports(tomllib.loads(text)))
    build = [programs / "build-fmu", folder / "rig.toml", "--out", folder, "--fmi", "3", "--library", programs / "libstickslip.so"]
    subprocess.run(build, check=True, capture_output=True)
    return folder / "ReducedRig.fmi3.fmu", folder / "ports.toml"


def main():
    """Diagnoses each case."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("records", type=pathlib.Path)
    arguments.add_argument("out", type=pathlib.Path)
    arguments.add_argument("cases", nargs="*")
    arguments.add_argument("--programs", type=pathlib.Path, default=ROOT / "target" / "release")
    given = arguments.parse_args()
    answers = json.loads((given.records / "ANSWERS.json").read_text())
    words = []
    for name in given.cases or sorted(answers):
        case, folder = given.records / name, given.out / name
        folder.mkdir(parents=True, exist_ok=True)
        fmu, file = exported(given.programs, case, folder)
        command = [given.programs / "stickslip", "diagnose", "--model", fmu, "--ports", file, "--out", folder / "fmu"]
        command += ["--held-out", case / "held-out.csv", "--records", *sorted(case.glob("run-*.csv"))]
        begun = time.monotonic()
        done = subprocess.run(command, capture_output=True, text=True)
        took = time.monotonic() - begun
        if done.returncode > 1:
            sys.exit(f"{name}: {done.stderr}")
        found = json.loads((folder / "fmu" / "finding.json").read_text())
        names = [effect["name"] for effect in found["effects"]]
        right = hidden(answers[name]["kind"])
        if set(names) == right:
            words.append("right")
        elif set(names) < right:
            words.append("less")
        elif found["verdict"] == "ambiguous" and right <= {*names, *found["alternatives"]}:
            words.append("open")
        else:
            words.append("wrong")
        rivals = f" (or {', '.join(found['alternatives'])})" if found["alternatives"] else ""
        said = f"{found['verdict']}: {', '.join(names)}{rivals}"
        print(f"{name} | {said} | exit code {done.returncode} | {words[-1]} | {took:.0f} s", flush=True)
    print(f"{words.count('right')} of {len(words)} right, {words.count('wrong')} with a wrong name")
    sys.exit("wrong" in words)


if __name__ == "__main__":
    main()
