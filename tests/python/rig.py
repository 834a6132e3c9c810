"""The dissertation's test at 55 rpm and 50 N, and a thin layer over fmpy that is the same for both versions."""

import math
import shutil

import fmpy
import numpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

SPEED = 55 * 2 * math.pi / 60  # rad/s at the gearbox output
OUTPUTS = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"]


def start_values(model_description):
    """Start values of all variables that have one, as numbers."""
    return {
        variable.name: float(variable.start)
        for variable in model_description.modelVariables
        if variable.start is not None and variable.type in ("Real", "Float64")
    }


def voltage_for(speed, values):
    """Voltage [V] that turns the unloaded rig at `speed` [rad/s] (open loop)."""
    ratio = values["gearbox.ratio"]
    current = (
        values["motor.viscous_damping"] * ratio * speed + values["motor.coulomb_torque"]
    ) / values["motor.torque_constant"]
    return values["motor.resistance"] * current + values["motor.back_emf_constant"] * ratio * speed


def simulate(path, step, stop, speed=SPEED, normal_force=50.0, **changes):
    """Result of fmpy.simulate_fmu at the given communication step [s], as a structured array."""
    description = fmpy.read_model_description(str(path))
    options = {name: changes.pop(name) for name in list(changes) if name.startswith("fmpy_")}
    values = start_values(description)
    values.update(changes.pop("parameters", {}))
    inputs = {"u": voltage_for(speed, values), "N2": normal_force}
    assert not changes, changes
    return fmpy.simulate_fmu(
        str(path),
        stop_time=stop,
        output_interval=step,
        start_values={**{k: v for k, v in values.items() if "." in k}, **inputs},
        output=OUTPUTS,
        **{name.removeprefix("fmpy_"): value for name, value in options.items()},
    )


class Component:
    """An instance that was taken to the end of its initialisation."""

    def __init__(self, path, start=0.0, values=None, logging=False, **instantiate):
        self.description = fmpy.read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.folder = fmpy.extract(str(path))
        self.is_fmi3 = self.description.fmiVersion.startswith("3")
        kind = FMU3Slave if self.is_fmi3 else FMU2Slave
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="rig",
        )
        self.fmu.instantiate(loggingOn=logging, **instantiate)
        values = values or {}
        self.set(values)
        if self.is_fmi3:
            self.fmu.enterInitializationMode(startTime=start)
        else:
            self.fmu.setupExperiment(startTime=start)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = start

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder)

    def set(self, values):
        references = [self.references[name] for name in values]
        if not references:
            return
        setter = self.fmu.setFloat64 if self.is_fmi3 else self.fmu.setReal
        setter(references, list(values.values()))

    def get(self, names=OUTPUTS):
        references = [self.references[name] for name in names]
        getter = self.fmu.getFloat64 if self.is_fmi3 else self.fmu.getReal
        return numpy.array(getter(references))

    def step(self, size):
        result = self.fmu.doStep(self.time, size)
        self.time += size
        return result


def standard_inputs(path, speed=SPEED, normal_force=50.0):
    """Inputs of the dissertation's test."""
    values = start_values(fmpy.read_model_description(str(path)))
    return {"u": voltage_for(speed, values), "N2": normal_force}
