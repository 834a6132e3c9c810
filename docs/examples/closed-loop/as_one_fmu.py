"""Rig and soft-torque controller packed into one FMU by fmucontainer, run in FMPy, FMI 2 and FMI 3."""

import json
import pathlib
import subprocess
import sys

import fmpy

from loop import NORMAL_FORCE, SPEED, STEP, STOP, constant_voltage, fmus, folder, save


def pack(version, out):
    """The container's path. Outputs and inputs of the same name are linked; free inputs and outputs are exposed."""
    rig, controller = (path.name for path in fmus(version, out))
    name = f"ControlledRig.fmi{version}"
    description = {
        "name": f"{name}.fmu",
        "fmu": [rig, controller],
        "step_size": STEP,
        "auto_link": True,
        "auto_input": True,
        "auto_output": True,
        "start": [[rig, "N2", NORMAL_FORCE], [controller, "omega_ref", SPEED]],
    }
    (out / f"{name}.json").write_text(json.dumps(description))
    program = pathlib.Path(sys.executable).parent / "fmucontainer"
    command = [program, "-fmu-directory", out, "-container", f"{name}.json", "-fmi", str(version)]
    subprocess.run(command, check=True, capture_output=True)
    return out / f"{name}.fmu"


def run(container):
    """Velocities of disc D2 at the communication points."""
    result = fmpy.simulate_fmu(
        str(container),
        stop_time=STOP,
        output_interval=STEP,
        start_values={"N2": NORMAL_FORCE, "omega_ref": SPEED},
        output=["theta_dot"],
    )
    return result["theta_dot"][1:]


if __name__ == "__main__":
    out = folder()
    runs = {f"FMI {version}": run(pack(version, out)) for version in (2, 3)}
    title = "Rig and soft-torque controller as one FMU in FMPy"
    save(out, "as_one_fmu", title, constant_voltage(fmus(2, out)[0]), runs)
