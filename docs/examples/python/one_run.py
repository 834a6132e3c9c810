"""One run of a study, as Dask's workers do it: the FMU arrives as bytes."""

import functools
import pathlib
import tempfile

import rig

COLUMNS = ["speed_rpm", "normal_force", "lowest", "highest", "stuck_share"]


@functools.cache
def kept(content):
    """Path of the FMU in a folder of this process, written once."""
    path = pathlib.Path(tempfile.mkdtemp(prefix="fmu-")) / "model.fmu"
    path.write_bytes(content)
    return str(path)


def row(content, speed_rpm, normal_force, stop):
    """Velocities [rad/s] of disc D2 in the last third of a run of `stop` seconds, and the share of it that the disc sticks."""
    fmu = kept(content)
    voltage = rig.voltage_for(fmu, speed_rpm)
    run = rig.simulate(fmu, stop, outputs=["theta_dot", "stuck"], u=voltage, N2=normal_force)
    late = run[run.index > stop * 2 / 3]
    return [
        speed_rpm,
        normal_force,
        float(late["theta_dot"].min()),
        float(late["theta_dot"].max()),
        float(late["stuck"].mean()),
    ]
