"""What a parameter does: one run for each value, in one table and one picture.

    python change_parameters.py out/ReducedRig.fmi3.fmu contact.mu_s 0.13 0.16 0.2 --out out/python
"""

import command_line
import pandas
import rig
from fmpy.fmi1 import FMICallException
from matplotlib import pyplot

parser = command_line.parser(__doc__)
parser.add_argument("fmu", type=command_line.fmu)
parser.add_argument("parameter", help="as in the model description, such as contact.mu_s")
parser.add_argument("values", type=command_line.number, nargs="+", help="in SI units")
parser.add_argument("--speed-rpm", type=command_line.number, default=55.0)
parser.add_argument("--normal-force", type=command_line.force, default=50.0, help="[N]")
parser.add_argument("--stop", type=command_line.positive, default=20.0, help="[s]")
parser.add_argument("--out", type=command_line.folder, required=True)
arguments = parser.parse_args()
known = rig.start_values(arguments.fmu)
if arguments.parameter not in known:
    parser.error(f"{arguments.parameter} is no parameter of this FMU; it has {', '.join(known)}")

voltage = rig.voltage_for(arguments.fmu, arguments.speed_rpm)
runs = pandas.DataFrame()
for value in arguments.values:
    changed = {"u": voltage, "N2": arguments.normal_force, arguments.parameter: value}
    try:
        runs[value] = rig.simulate(arguments.fmu, arguments.stop, **changed)["theta_dot"]
    except FMICallException:
        # The FMU said why, and FMPy printed it.
        parser.error(f"the FMU does not take {arguments.parameter} = {value:g}")
runs.to_csv(arguments.out / "parameters.csv")
axes = runs.plot(figsize=(9, 4), xlabel="time [s]", ylabel="velocity of disc D2 [rad/s]")
axes.legend(title=arguments.parameter, loc="upper right")
axes.figure.savefig(arguments.out / "parameters.png", dpi=120)

settled = runs[runs.index > arguments.stop / 2]
print(settled.agg(["min", "max"]).T.rename_axis(arguments.parameter).round(3).to_string())
print(arguments.out / "parameters.png")
