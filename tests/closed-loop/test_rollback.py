"""Rolled-back steps leave no trace: a loop that saves, steps, restores and steps again goes bit for bit the same way."""

import math
import pathlib
import subprocess
import sys

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))
from rig import Component  # noqa: E402  found through the path above

STEP = 0.005
SPEED = 55 * 2 * math.pi / 60


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmus")
    for model in ("reduced-rig", "soft-torque", "speed-controller"):
        command = [ROOT / "target/release/build-fmu", ROOT / f"modelDescription/{model}.toml", "--out", folder]
        subprocess.run(command, check=True, capture_output=True)
    return folder


class Loop:
    def __init__(self, folder, version, controller):
        self.rig = Component(folder / f"ReducedRig.{version}.fmu", values={"N2": 50.0})
        self.controller = Component(folder / f"{controller}.{version}.fmu", values={"omega_ref": SPEED})
        self.measured = [name for name in ("theta3_dot", "i") if name in self.controller.references]

    def step(self, size):
        self.controller.set(dict(zip(self.measured, self.rig.get(self.measured))))
        self.rig.set({"u": self.controller.get(["u"])[0]})
        self.controller.step(size)
        self.rig.step(size)

    def outputs(self):
        return numpy.concatenate([self.rig.get(), self.controller.get(["u", "integral"])])

    def save(self):
        parts = (self.rig, self.controller)
        return [(part, part.time, part.fmu.getFMUState()) for part in parts]

    def restore(self, saved, free=True):
        for part, time, state in saved:
            part.fmu.setFMUState(state)
            part.time = time
            if free:
                part.fmu.freeFMUState(state)

    def close(self):
        for part in (self.rig, self.controller):
            part.__exit__()


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
@pytest.mark.parametrize("controller, stop", [("SoftTorque", 8.0), ("SpeedController", 2.0)])
def test_rolled_back_steps_leave_no_trace(folder, version, controller, stop):
    plain, rolled = (Loop(folder, version, controller) for _ in range(2))
    for number in range(round(stop / STEP)):
        saved = rolled.save()
        # What an adaptive master tries first: two half steps, then one twice as long.
        rolled.step(STEP / 2)
        rolled.step(STEP / 2)
        rolled.restore(saved, free=False)
        rolled.step(2 * STEP)
        rolled.restore(saved)
        rolled.step(STEP)
        plain.step(STEP)
        assert numpy.array_equal(plain.outputs(), rolled.outputs()), f"step {number}"
    assert plain.rig.get(["theta3"])[0] != 0.0
    plain.close()
    rolled.close()
