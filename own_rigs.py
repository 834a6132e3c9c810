"""Exports each practice model as an FMU, diagnoses it as a foreign one, and compares the names with ANSWERS.json."""
import json, subprocess, sys, time, os, pathlib, tomllib
practice, out, bins, library = map(pathlib.Path, sys.argv[1:5])
only = sys.argv[5:]
PORTS = '''
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
'''
UNCERTAIN = {"disc.inertia": ("kg.m2", .006), "shaft.stiffness": ("N.m/rad", .02), "shaft.damping": ("N.m.s/rad", .06),
  "motor.resistance": ("Ohm", .02), "motor.torque_constant": ("N.m/A", .02), "motor.back_emf_constant": ("V.s/rad", .01),
  "motor.coulomb_torque": ("N.m", .04), "contact.mu_c": ("1", .02), "contact.mu_s": ("1", .02), "contact.mu": ("1", .02),
  "contact.a1": ("1", .02), "contact.a2": ("1", .02)}
def ports(model):
    lines = []
    for name, (unit, share) in UNCERTAIN.items():
        section, key = name.split(".")
        if key in model[section]:
            drift = "" if key == "resistance" else ""
            lines.append(f'"{name}" = {{ value = {float(model[section][key])!r}, unit = "{unit}", relative_uncertainty = {share}{drift} }}')
    return f'''[plant]
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
measured_position = {{ column = "theta3", unit = "rad" }}
measured_velocity = {{ column = "theta3_dot", unit = "rad/s" }}
repeats = [16.0]
compare_low_pass = 20.0

[inputs]
u = {{ column = "u", unit = "V", between = "held" }}
N2 = {{ column = "N2", unit = "N", between = "held", may_be_offset = true }}

[columns]
time = {{ column = "time", unit = "s" }}
position = {{ column = "theta", unit = "rad" }}
velocity = {{ column = "theta_dot", unit = "rad/s" }}
load = {{ column = "N2", unit = "N" }}

[measurement]
motion_low_pass = 25.0
compare_low_pass = 8.0
compare_rate = 50.0
edge = 0.5
standstill_speed = 0.2

[drifts]
parameters = ["motor.resistance"]

[parameters]
''' + "\n".join(lines) + "\n"
for case in sorted(json.load(open(practice / "ANSWERS.json"))):
    if only and case not in only: continue
    src, here = practice / case, out / case
    here.mkdir(parents=True, exist_ok=True)
    text = (src / "model.toml").read_text()
    (here / "rig.toml").write_text(text + PORTS)
    subprocess.run([bins / "build-fmu", here / "rig.toml", "--out", here, "--fmi", "3", "--library", library], check=True, stdout=subprocess.DEVNULL)
    (here / "ports.toml").write_text(ports(tomllib.loads(text)))
    runs = sorted(src.glob("run-*.csv"))
    begun = time.time()
    done = subprocess.run([bins / "stickslip", "diagnose", "--model", here / "ReducedRig.fmi3.fmu", "--ports", here / "ports.toml",
        "--records", *runs, "--held-out", src / "held-out.csv", "--out", here / "result", *os.environ.get("MORE", "").split()], capture_output=True, text=True)
    took = time.time() - begun
    if done.returncode > 1:
        print(f"{case:32} FAILED {done.stderr[-400:]}", flush=True); continue
    f = json.load(open(here / "result" / "finding.json"))
    print(f"{case:32} {f['verdict']:16} {', '.join(e['name'] for e in f['effects'])} | {', '.join(f['alternatives'])} {took:.0f} s", flush=True)
