"""Rig and soft-torque controller under ecos, FMI 2 and FMI 3, wired by hand and from a system structure archive."""

import ctypes
import pathlib
import subprocess
import sys

from loop import BUILD_FMU, NORMAL_FORCE, ROOT, SPEED, STEP, STOP, constant_voltage, fmus, folder, save

# The library of ecospy wants libtbb, which its package does not name as a requirement.
ctypes.CDLL(str(pathlib.Path(sys.prefix) / "lib" / "libtbb.so.12"), ctypes.RTLD_GLOBAL)
from ecospy import EcosSimulation, EcosSimulationStructure  # noqa: E402  needs the library above


def run(simulation, rig, start_values):
    """Velocities of disc D2 at the communication points."""
    simulation.init(parameter_set=start_values)
    velocities = []
    for _ in range(round(STOP / STEP)):
        simulation.step(1)
        velocities.append(simulation.get_real(f"{rig}::theta_dot"))
    simulation.terminate()
    simulation.free()
    return velocities


def wired(version, out):
    rig, controller = fmus(version, out)
    structure = EcosSimulationStructure()
    structure.add_model("rig", str(rig))
    structure.add_model("controller", str(controller))
    for measured in ("theta3_dot", "i"):
        structure.make_real_connection(f"rig::{measured}", f"controller::{measured}")
    structure.make_real_connection("controller::u", "rig::u")
    structure.add_parameter_set("start", {"controller::omega_ref": SPEED, "rig::N2": NORMAL_FORCE})
    return run(EcosSimulation(step_size=STEP, structure=structure), "rig", "start")


def from_archive(version, out):
    models = [ROOT / "modelDescription" / f"{model}.toml" for model in ("reduced-rig", "soft-torque")]
    starts = ["--start", f"omega_ref={SPEED!r}", "--start", f"N2={NORMAL_FORCE}"]
    command = [BUILD_FMU, "ssp", *models, *starts, "--fmi", str(version), "--out", out]
    archive = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    return run(EcosSimulation(step_size=STEP, ssp_path=archive), "ReducedRig", "start_values")


if __name__ == "__main__":
    out = folder()
    runs = {f"FMI {version}": wired(version, out) for version in (2, 3)}
    runs |= {f"FMI {version} from SSP": from_archive(version, out) for version in (2, 3)}
    without = constant_voltage(fmus(2, out)[0])
    save(out, "with_ecos", "Rig and soft-torque controller under ecos", without, runs)
