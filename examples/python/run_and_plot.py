"""Runs the FMU of a rig with FMPy and plots it.

    python run_and_plot.py out/ReducedRig.fmi3.fmu --speed-rpm 55 --normal-force 50 --out out/python
"""

import command_line
import rig
from matplotlib import pyplot

parser = command_line.parser(__doc__)
parser.add_argument("fmu", type=command_line.fmu)
parser.add_argument("--speed-rpm", type=command_line.number, default=55.0, help="of the gearbox output without load")
parser.add_argument("--normal-force", type=command_line.force, default=50.0, help="of the pin on disc D2 [N]")
parser.add_argument("--stop", type=command_line.positive, default=60.0, help="[s]")
parser.add_argument("--out", type=command_line.folder, required=True)
arguments = parser.parse_args()

voltage = rig.voltage_for(arguments.fmu, arguments.speed_rpm)
run = rig.simulate(arguments.fmu, arguments.stop, u=voltage, N2=arguments.normal_force)
run.to_csv(arguments.out / "run.csv")

figure, (velocity, friction) = pyplot.subplots(2, sharex=True, figsize=(9, 5), layout="constrained")
velocity.plot(run["theta3_dot"], color="0.6", label="gearbox output")
velocity.plot(run["theta_dot"], label="disc D2")
velocity.set(ylabel="velocity [rad/s]", title=f"{voltage:.3f} V, {arguments.normal_force:g} N")
velocity.legend(loc="upper right")
friction.plot(run["T_f"], color="tab:red")
friction.set(xlabel="time [s]", ylabel="friction torque [N m]")
figure.savefig(arguments.out / "run.png", dpi=120)

settled = run["theta_dot"][run.index > 2 / 3 * arguments.stop]
print(f"disc D2 between {settled.min():.3f} and {settled.max():.3f} rad/s in the last third")
print(arguments.out / "run.png")
