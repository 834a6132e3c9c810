"""What a parameter does: one run for each value, in one table and one picture.

    python change_parameters.py out/ReducedRig.fmi3.fmu contact.mu_s 0.13 0.16 0.2 --out out/python
"""

import argparse
import pathlib

import pandas
import rig
from matplotlib import pyplot

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("fmu", type=pathlib.Path)
parser.add_argument("parameter", help="as in the model description, such as contact.mu_s")
parser.add_argument("values", type=float, nargs="+", help="in SI units")
parser.add_argument("--speed-rpm", type=float, default=55.0)
parser.add_argument("--normal-force", type=float, default=50.0, help="[N]")
parser.add_argument("--stop", type=float, default=20.0, help="[s]")
parser.add_argument("--out", type=pathlib.Path, required=True)
arguments = parser.parse_args()
known = rig.start_values(arguments.fmu)
if arguments.parameter not in known:
    parser.error(f"{arguments.parameter} is no parameter of this FMU; it has {', '.join(known)}")
arguments.out.mkdir(parents=True, exist_ok=True)

voltage = rig.voltage_for(arguments.fmu, arguments.speed_rpm)
runs = pandas.DataFrame(
    {
        value: rig.simulate(
            arguments.fmu, arguments.stop, u=voltage, N2=arguments.normal_force, **{arguments.parameter: value}
        )["theta_dot"]
        for value in arguments.values
    }
)
runs.to_csv(arguments.out / "parameters.csv")
axes = runs.plot(figsize=(9, 4), xlabel="time [s]", ylabel="velocity of disc D2 [rad/s]")
axes.legend(title=arguments.parameter, loc="upper right")
axes.figure.savefig(arguments.out / "parameters.png", dpi=120)

settled = runs[runs.index > arguments.stop / 2]
print(settled.agg(["min", "max"]).T.rename_axis(arguments.parameter).round(3).to_string())
print(arguments.out / "parameters.png")
