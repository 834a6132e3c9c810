"""Rig and soft-torque controller under libcosim, FMI 2, wired by hand and from a system structure archive."""

import subprocess
import zipfile

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from loop import BUILD_FMU, NORMAL_FORCE, ROOT, SPEED, STEP, STOP, constant_voltage, fmus, folder, save

NANOSECONDS = 1_000_000_000


def references(execution, slave):
    """Value references by name."""
    return {variable.name.decode(): variable.reference for variable in execution.slave_variables(slave)}


def run(execution, rig):
    """Velocities of disc D2 at the communication points."""
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    velocity = references(execution, rig)["theta_dot"]
    velocities = []
    for _ in range(round(STOP / STEP)):
        assert execution.step(), execution.status()
        velocities.append(observer.last_real_values(rig, [velocity])[0])
    return velocities


def wired(out):
    execution = CosimExecution.from_step_size(round(STEP * NANOSECONDS))
    paths = zip(fmus(2, out), ("rig", "controller"))
    rig, controller = [execution.add_local_slave(CosimLocalSlave(str(path), name)) for path, name in paths]
    of_rig, of_controller = references(execution, rig), references(execution, controller)
    for measured in ("theta3_dot", "i"):
        execution.connect_real_variables(rig, of_rig[measured], controller, of_controller[measured])
    execution.connect_real_variables(controller, of_controller["u"], rig, of_rig["u"])
    execution.real_initial_value(rig, of_rig["N2"], NORMAL_FORCE)
    execution.real_initial_value(controller, of_controller["omega_ref"], SPEED)
    return run(execution, rig)


def from_archive(out):
    models = [ROOT / "modelDescription" / f"{model}.toml" for model in ("reduced-rig", "soft-torque")]
    starts = ["--start", f"omega_ref={SPEED!r}", "--start", f"N2={NORMAL_FORCE}"]
    command = [BUILD_FMU, "ssp", *models, *starts, "--out", out]
    archive = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    unpacked = out / "unpacked-ssp"  # libcosim reads a folder, not the archive
    with zipfile.ZipFile(archive) as file:
        file.extractall(unpacked)
    execution = CosimExecution.from_ssp_file(str(unpacked), step_size=round(STEP * NANOSECONDS))
    return run(execution, execution.slave_index_from_instance_name("ReducedRig"))


if __name__ == "__main__":
    out = folder()
    log_output_level(CosimLogLevel.WARNING)
    runs = {"FMI 2": wired(out), "FMI 2 from SSP": from_archive(out)}
    save(out, "with_libcosim", "Rig and soft-torque controller under libcosim", constant_voltage(fmus(2, out)[0]), runs)
