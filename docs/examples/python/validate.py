"""How well FMUs agree with a record: the record's inputs go in, the report's measures come out.

    python validate.py record.csv before.fmu after.fmu --out out/python

One run from the record's start says little of a rig that sticks and slips: a phase that has drifted makes a good model look
bad. So each FMU is also restarted from the record every 0.25 s (`windows`); by these it is judged.
"""

import command_line
import numpy
import pandas
import rig
from matplotlib import pyplot

WINDOW = 0.25  # s
STATES = ["theta", "theta_dot", "theta3", "theta3_dot"]


def free_run(fmu, record):
    """Velocity of disc D2 in one run from the record's first row."""
    run = rig.simulate(
        fmu, record.index[-1], step_of(record), record[["u", "N2"]], ["theta_dot"], record.index[0],
        **starts(fmu, record.iloc[0]),
    )
    return run["theta_dot"]


def windows(fmu, record):
    """Velocity of disc D2 in runs that start anew from the record every 0.25 s."""
    rows = round(WINDOW / step_of(record))
    pieces = []
    for first in range(0, len(record) - rows, rows):
        part = record.iloc[first : first + rows + 1]
        run = rig.simulate(
            fmu, part.index[-1], step_of(record), part[["u", "N2"]], ["theta_dot"], part.index[0],
            **starts(fmu, part.iloc[0]),
        )
        pieces.append(run["theta_dot"].iloc[1:])
    return pandas.concat(pieces)


def step_of(record):
    """Interval between rows [s]."""
    return float(numpy.median(numpy.diff(record.index)).round(9))


def starts(fmu, row):
    """States at a row; the current, which is not measured, at its equilibrium with the motor's velocity."""
    value = rig.start_values(fmu)
    motor_speed = value["gearbox.ratio"] * row["theta3_dot"]
    current = (row["u"] - value["motor.back_emf_constant"] * motor_speed) / value["motor.resistance"]
    return {**row[STATES], "i": current, "u": row["u"], "N2": row["N2"]}


if __name__ == "__main__":
    parser = command_line.parser(__doc__)
    parser.add_argument("record", type=command_line.record, help=f"CSV: time, {', '.join(command_line.COLUMNS)}")
    parser.add_argument("fmus", type=command_line.fmu, nargs="+")
    parser.add_argument("--out", type=command_line.folder, required=True)
    arguments = parser.parse_args()

    record = arguments.record
    measured = record["theta_dot"]
    wanted = record["theta3_dot"].mean()
    figure, axes = pyplot.subplots(figsize=(9, 4), layout="constrained")
    axes.plot(measured, ".", color="0.6", markersize=2, label="record")
    rows = {}
    for fmu in arguments.fmus:
        for name, series in [("free run", free_run(fmu, record)), ("windows", windows(fmu, record))]:
            rows[str(fmu), name] = rig.measures(series, measured.loc[series.index], wanted)
        axes.plot(series, label=str(fmu))
    table = pandas.DataFrame(rows).T.rename_axis(["FMU", "runs"])
    table.to_csv(arguments.out / "measures.csv")
    axes.set(xlabel="time [s]", ylabel="velocity of disc D2 [rad/s]", title=f"restarted every {WINDOW} s")
    figure.legend(loc="outside lower center")
    figure.savefig(arguments.out / "validation.png", dpi=120)
    print(table.round(4).to_string())
    print(arguments.out / "validation.png")
