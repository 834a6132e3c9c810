"""Exported joints in MuJoCo: they load, and move as the model does within the error that the file states."""

import pathlib
import subprocess

import fmpy
import mujoco
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "target" / "release"
STEP = 1e-4

AXIS = """
[plant]
kind = "drive"
path = "turn"
[drive]
inertia = 0.02
viscous = 0.01
offset = 0.0
[coulomb_friction]
force = 0.15
[stribeck]
excess = 0.08
speed = 0.5
"""

ARM = """
[plant]
kind = "joint"
path = "turn"
[joint]
stiffness = 30.0
rest = 0.0
viscous = 1.0
gain = 15.0
back_emf = 10.0
[coulomb_friction]
force = 4.0
"""


def exported(folder, model, body, *options):
    """MuJoCo's model of this body with the joint of a model file."""
    (folder / "model.toml").write_text(model)
    command = [PROGRAMS / "stickslip", "export", folder / "model.toml", "--to", "mujoco", "--name", "elbow", *options]
    subprocess.run([*command, "--out", folder / "elbow.xml"], check=True)
    (folder / "robot.xml").write_text(f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{STEP}" gravity="0 0 -9.81" integrator="implicitfast"/>
  <include file="elbow.xml"/>
  {body}
</mujoco>
""")
    return mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))


def ours(folder, stop, **start):
    """Position and velocity of the model file, every hundredth of a second."""
    subprocess.run([PROGRAMS / "stickslip", "build", folder / "model.toml", "--fmi", "3", "--out", folder], check=True)
    (fmu,) = folder.glob("*.fmu")
    names = ["position", "velocity"]
    return fmpy.simulate_fmu(str(fmu), stop_time=stop, output_interval=0.01, start_values=start, output=names)


def theirs(model, stop, velocity=0.0, control=()):
    """The same of MuJoCo."""
    data = mujoco.MjData(model)
    data.qvel[0] = velocity
    data.ctrl[:] = control
    rows = [(0.0, velocity)]
    for _ in range(round(stop / 0.01)):
        mujoco.mj_step(model, data, round(0.01 / STEP))
        rows.append((data.qpos[0], data.qvel[0]))
    return numpy.array(rows)


def test_a_free_joint_decays_within_the_stated_error(tmp_path):
    body = """
  <worldbody><body>
    <joint class="elbow" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="1" diaginertia="0.015 0.015 0.015"/>
  </body></worldbody>"""
    model = exported(tmp_path, AXIS, body, "--speed", "0.2:6", "--rotor-inertia", "5e-7", "--ratio", "100")
    assert model.dof_armature[0] == 0.005
    assert list(model.numeric("elbow_speed_range").data) == [0.2, 6.0]
    (error,) = model.numeric("elbow_largest_error").data
    own = ours(tmp_path, 0.8, velocity=6.0)
    other = theirs(model, 0.8, velocity=6.0)
    inside = numpy.minimum(own["velocity"], other[:, 1]) >= 0.2
    times, difference = own["time"][inside], abs(own["velocity"] - other[:, 1])[inside]
    assert inside.sum() > 45, "most of the decay is compared"
    # Both are damped, so that an error of the torque adds up at most; a step of MuJoCo is of first order.
    assert (difference <= error / 0.02 * times + 2e-3).all(), difference
    assert max(error / 0.02 * times) < 0.2 * 6.0, "the bound says something"


def test_a_motor_under_a_voltage_turns_the_arm_as_ours_does(tmp_path):
    # 0.36 N m where the arm is level, and 0.012 kg m² with the motor's part.
    body = """
  <worldbody><body>
    <joint name="q" class="elbow" axis="0 -1 0"/>
    <inertial pos="0 0 -0.0611621" mass="0.6" diaginertia="0.00726028 0.00726028 0.00726028"/>
  </body></worldbody>
  <actuator><general class="elbow" joint="q"/></actuator>"""
    options = ["--speed", "0:20", "--inertia", "0.012", "--rotor-inertia", "3e-8", "--ratio", "288.4"]
    model = exported(tmp_path, ARM, body, *options)
    own = ours(tmp_path, 1.5, voltage=12.0, connected=1.0)
    other = theirs(model, 1.5, control=[12.0])
    assert own["position"][-1] > 15.0
    assert max(abs(own["position"] - other[:, 0])) < 0.01
