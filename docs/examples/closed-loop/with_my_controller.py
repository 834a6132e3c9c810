"""The rig with a controller that a user wrote in Python (my_controller.py, packed by pythonfmu), in FMPy."""

import shutil
import subprocess
import sys
import pathlib

import fmpy
from fmpy.fmi2 import FMU2Slave

from loop import NORMAL_FORCE, SPEED, STEP, STOP, constant_voltage, fmus, folder, save


class Component:
    """An FMU that has gone through its initialisation with these start values."""

    def __init__(self, path, start_values):
        description = fmpy.read_model_description(str(path))
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.folder = fmpy.extract(str(path))
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.set(start_values)
        self.fmu.exitInitializationMode()

    def set(self, values):
        self.fmu.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, names):
        return dict(zip(names, self.fmu.getReal([self.references[name] for name in names])))

    def step(self, time):
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=STEP)

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder)


def pack(out):
    """Packs my_controller.py as its docstring says."""
    source = pathlib.Path(__file__).with_name("my_controller.py")
    program = pathlib.Path(sys.executable).parent / "pythonfmu"
    subprocess.run([program, "build", "-f", source, "-d", out], check=True, capture_output=True)
    return out / "MyController.fmu"


def run(rig_path, controller_path):
    """Velocities of disc D2 at the communication points."""
    rig = Component(rig_path, {"N2": NORMAL_FORCE})
    controller = Component(controller_path, {"omega_ref": SPEED})
    velocities = []
    for number in range(round(STOP / STEP)):
        controller.set(rig.get(["i"]))
        rig.set(controller.get(["u"]))
        controller.step(number * STEP)
        rig.step(number * STEP)
        velocities.append(rig.get(["theta_dot"])["theta_dot"])
    controller.close()
    rig.close()
    return velocities


if __name__ == "__main__":
    out = folder()
    rig = fmus(2, out)[0]
    runs = {"MyController (Python)": run(rig, pack(out))}
    save(out, "with_my_controller", "Rig and a user's controller in Python", constant_voltage(rig), runs)
