"""What the command lines of the examples share. What is wrong with an argument ends the program with exit code 2 and one
line that says which, what it was and what is right."""

import argparse
import math
import pathlib

import numpy
import pandas

COLUMNS = ["u", "N2", "theta", "theta_dot", "theta3", "theta3_dot"]


def model(text):
    """A rig from its model file."""
    # The other examples need no package, and these two no FMPy.
    import stickslip

    try:
        return stickslip.Rig.from_toml(text)
    except stickslip.InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def fmu(text):
    """Path of an FMU of a rig."""
    import rig

    try:
        variables = rig.variables(text)
    except Exception as error:  # FMPy raises many kinds
        raise argparse.ArgumentTypeError(f"{text} cannot be read as an FMU: {error}") from error
    for name in ("u", "N2", "theta_dot"):
        if name not in variables:
            raise argparse.ArgumentTypeError(f"{text} is no FMU of a rig: it has no variable {name}")
    return pathlib.Path(text)


def record(text):
    """A record (CSV, `time` first) as a table."""
    import rig

    try:
        table = rig.read_record(text)
    except (OSError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"{text} cannot be read as a record: {error}") from error
    missing = [name for name in COLUMNS if name not in table]
    if missing:
        raise argparse.ArgumentTypeError(f"{text} has no column {', '.join(missing)}; it has {', '.join(table)}")
    for name in COLUMNS:
        if not numpy.isfinite(pandas.to_numeric(table[name], errors="coerce")).all():
            raise argparse.ArgumentTypeError(f"{text}: column {name} has something that is no finite number")
    steps = numpy.diff(table.index)
    if len(steps) == 0 or not (steps > 0).all() or numpy.ptp(steps) > 1e-6:
        raise argparse.ArgumentTypeError(f"{text}: times must rise by the same interval from row to row")
    return table


def number(text):
    """A finite number."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not finite")
    return value


def positive(text):
    """A finite number above zero."""
    value = number(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text} is not above zero")
    return value


def count(text):
    """A whole number of one or more."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not 1 or more")
    return value


def force(text):
    """A normal force [N]; a pin cannot pull."""
    value = number(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text} N is below zero, and a pin cannot pull")
    return value


def folder(text):
    """A folder for results, made if it is not there."""
    path = pathlib.Path(text)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise argparse.ArgumentTypeError(f"the folder {text} cannot be made: {error.strerror}") from error
    return path


def parser(description):
    """A parser that prints the description as it is written."""
    return argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
