"""What the examples share: an FMU of the rig as a function from pandas to pandas.

Tables have the time [s] as index and FMU variable names as columns; everything is in SI units.
"""

import functools
import math

import fmpy
import numpy
import pandas

# What a record holds, and what runs are compared by.
OUTPUTS = ["theta", "theta_dot", "theta3", "theta3_dot", "i", "T_f"]


@functools.cache
def opened(fmu):
    """Description and unpacked folder of an FMU, read once."""
    return fmpy.read_model_description(fmu), fmpy.extract(fmu)


def variables(fmu):
    """All variables by name."""
    description, _ = opened(str(fmu))
    return {v.name: v for v in description.modelVariables}


def start_values(fmu):
    """Start values of the parameters by name."""
    return {name: float(v.start) for name, v in variables(fmu).items() if v.causality == "parameter"}


def voltage_for(fmu, speed_rpm):
    """Motor voltage [V] that turns the unloaded rig at `speed_rpm` in open loop, as the dissertation's tests do."""
    value = start_values(fmu)
    motor_speed = value["gearbox.ratio"] * speed_rpm * math.pi / 30
    direction = (speed_rpm > 0) - (speed_rpm < 0)
    torque = value["motor.viscous_damping"] * motor_speed + value["motor.coulomb_torque"] * direction
    current = torque / value["motor.torque_constant"]
    return value["motor.resistance"] * current + value["motor.back_emf_constant"] * motor_speed


def simulate(fmu, stop, step=0.01, inputs=None, outputs=OUTPUTS, start=0.0, **values):
    """A run from `start` to `stop` [s] as a table.

    `inputs` is a table of input columns, held between its rows; `values` are start values of inputs, parameters and
    states, whose dots may be written as two underscores (`contact__mu_s=0.25`).
    """
    description, folder = opened(str(fmu))
    result = fmpy.simulate_fmu(
        folder,
        model_description=description,
        start_time=start,
        stop_time=stop,
        output_interval=step,
        start_values={name.replace("__", "."): value for name, value in values.items()},
        input=None if inputs is None else held(inputs),
        output=outputs,
    )
    table = pandas.DataFrame.from_records(result)
    # FMPy counts time up in steps; its last digits are rounding.
    table["time"] = table["time"].round(9)
    return table.set_index("time")[outputs]


def held(inputs):
    """A table as FMPy's input signal, each value held until the next row: two rows at the same time make a step."""
    rows = inputs.reset_index(names="time")
    before = rows.shift(1)
    before["time"] = rows["time"]
    both = pandas.concat([before.iloc[1:], rows]).sort_values("time", kind="stable")
    return both.to_records(index=False)


def read_record(path):
    """A record (CSV, `time` first) as a table; the last digits of times are rounding."""
    table = pandas.read_csv(path, index_col="time")
    table.index = table.index.astype(float).to_numpy().round(9)
    return table.rename_axis("time")


def measures(model, record, reference):
    """The report's measures of agreement between two series of a velocity, `reference` being the wanted velocity.

    rmse [rad/s], nrmse = rmse/reference, pc (Pearson's correlation, 1 = same shape), apl (amplitude pulse level,
    0 = the same strength of pulsation).
    """
    model, record = numpy.asarray(model), numpy.asarray(record)
    rmse = float(numpy.sqrt(numpy.mean((model - record) ** 2)))
    deviations = model.std(), record.std()
    return {
        "rmse": rmse,
        "nrmse": rmse / reference,
        "pc": float(numpy.corrcoef(model, record)[0, 1]),
        "apl": float(abs(deviations[0] - deviations[1]) / sum(deviations)),
    }
