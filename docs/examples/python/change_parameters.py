"""What a parameter does: one run for each value, in one table and one picture.

    python change_parameters.py modelDescription/reduced-rig.toml contact.mu_s 0.13 0.16 0.2 --out out/python
"""

import command_line
import pandas
import stickslip

parser = command_line.parser(__doc__)
parser.add_argument("model", type=command_line.model)
parser.add_argument("parameter", help="its dotted name, such as contact.mu_s")
parser.add_argument("values", type=command_line.number, nargs="+", help="in SI units")
parser.add_argument("--speed-rpm", type=command_line.number, default=55.0)
parser.add_argument("--normal-force", type=command_line.force, default=50.0, help="[N]")
parser.add_argument("--stop", type=command_line.positive, default=20.0, help="[s]")
parser.add_argument("--out", type=command_line.folder, required=True)
arguments = parser.parse_args()

runs = pandas.DataFrame()
for value in arguments.values:
    try:
        changed = arguments.model.with_({arguments.parameter: value})
        run = changed.simulate(
            speed_rpm=arguments.speed_rpm, normal_force=arguments.normal_force, stop=arguments.stop
        )
    except stickslip.InputError as error:
        parser.error(str(error))
    runs[value] = run["theta_dot"]
runs.to_csv(arguments.out / "parameters.csv")
axes = runs.plot(figsize=(9, 4), xlabel="time [s]", ylabel="velocity of disc D2 [rad/s]")
axes.legend(title=arguments.parameter, loc="upper right")
axes.figure.savefig(arguments.out / "parameters.png", dpi=120)

settled = runs[runs.index > arguments.stop / 2]
print(settled.agg(["min", "max"]).T.rename_axis(arguments.parameter).round(3).to_string())
print(arguments.out / "parameters.png")
