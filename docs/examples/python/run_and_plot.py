"""Runs a rig and plots it.

    python run_and_plot.py modelDescription/reduced-rig.toml --speed-rpm 55 --normal-force 50 --out out/python
"""

import command_line
import stickslip

parser = command_line.parser(__doc__)
parser.add_argument("model", type=command_line.model)
parser.add_argument("--speed-rpm", type=command_line.number, default=55.0, help="of the gearbox output without load")
parser.add_argument("--normal-force", type=command_line.force, default=50.0, help="of the pin on disc D2 [N]")
parser.add_argument("--stop", type=command_line.positive, default=60.0, help="[s]")
parser.add_argument("--out", type=command_line.folder, required=True)
arguments = parser.parse_args()

try:
    run = arguments.model.simulate(
        speed_rpm=arguments.speed_rpm, normal_force=arguments.normal_force, stop=arguments.stop
    )
except stickslip.InputError as error:
    parser.error(str(error))
run.frame.to_csv(arguments.out / "run.csv")
run.events.to_csv(arguments.out / "events.csv", index=False)
run.figure().savefig(arguments.out / "run.png", dpi=120)

lowest, highest = run.summary.velocity
print(f"{run.summary.motion}: disc D2 between {lowest:.3f} and {highest:.3f} rad/s in the last third")
print(arguments.out / "run.png")
