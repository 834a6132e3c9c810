"""A parameter study over many runs with Dask: kinds of motion over speed and normal force.

    python study.py out/ReducedRig.fmi3.fmu --speed-rpm 20 70 26 --normal-force 10 70 13 --out out/study

Without further words on this machine, with `--workers` processes; on a cluster the same with the address of its scheduler, which
dask-jobqueue (Slurm), dask-kubernetes or `dask scheduler` gives:

    python study.py … --scheduler tcp://host:8786

Workers need nothing but the packages of requirements.txt: the FMU travels with the runs. Rows are written as they come;
called again, the study goes on where it was. A worker that dies is replaced and its runs are done again.
"""

import csv
import hashlib
import itertools
import json
import pathlib
import sys

import command_line
import numpy
import one_run
import pandas
from distributed import Client, LocalCluster, as_completed
from distributed.scheduler import KilledWorker
from matplotlib import pyplot

HERE = pathlib.Path(__file__).parent


def done_before(path):
    """Points of a table that an earlier call left; a last line that was cut off is dropped."""
    if not path.exists():
        return set()
    lines = path.read_text().splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("\n")]
    path.write_text("".join(whole))
    return {tuple(float(word) for word in line.split(",")[:2]) for line in whole[1:]}


def same_study(out, fmu, stop):
    """Keeps what the rows of a table come from; whether those that are there come from the same."""
    path, study = out / "study.json", {"fmu": hashlib.sha256(fmu.read_bytes()).hexdigest(), "stop": stop}
    if path.exists() and (out / "study.csv").exists():
        return json.loads(path.read_text()) == study
    path.write_text(json.dumps(study))
    return True


def points_of(parser, axes):
    """All pairs of the values of two axes that are given as FIRST LAST COUNT."""
    values = []
    for name, (first, last, count) in axes.items():
        if count < 1 or count != int(count):
            parser.error(f"argument {name}: COUNT {count:g} is no whole number of 1 or more")
        values.append([round(float(value), 9) for value in numpy.linspace(first, last, int(count))])
    return list(itertools.product(*values))


def bar(done, total):
    """The progress on one line of the terminal."""
    filled = 40 * done // total
    sys.stderr.write(f"\r[{'#' * filled}{' ' * (40 - filled)}] {done}/{total}")
    sys.stderr.flush()


def study(client, content, points, stop, path):
    """Runs what is missing and appends each row as it comes."""
    before = done_before(path)
    left = [point for point in points if point not in before]
    for module in ("rig.py", "one_run.py"):
        client.upload_file(str(HERE / module))
    shared = client.scatter(content, broadcast=True)
    # `retries`: a run that ends with its worker is not the run's fault.
    futures = [client.submit(one_run.row, shared, *point, stop, pure=False, retries=3) for point in left]
    new = not path.exists() or path.stat().st_size == 0
    with open(path, "a", newline="") as file:
        writer = csv.writer(file)
        if new:
            writer.writerow(one_run.COLUMNS)
        bar(len(points) - len(left), len(points))
        for count, future in enumerate(as_completed(futures), 1):
            writer.writerow(future.result())
            file.flush()
            bar(len(points) - len(left) + count, len(points))
    sys.stderr.write("\n")


def picture(path, out):
    """Share of the time that the disc sticks, over speed and normal force."""
    table = pandas.read_csv(path).pivot(index="normal_force", columns="speed_rpm", values="stuck_share").sort_index()
    figure, axes = pyplot.subplots(figsize=(7, 4.5), layout="constrained")
    mesh = axes.pcolormesh(table.columns, table.index, table.to_numpy(), shading="nearest", vmin=0.0)
    axes.set(xlabel="speed without load [rpm]", ylabel="normal force [N]")
    figure.colorbar(mesh, label="share of the time stuck")
    figure.savefig(out / "study.png", dpi=120)
    print(out / "study.png")


def main():
    parser = command_line.parser(__doc__)
    parser.add_argument("fmu", type=command_line.fmu)
    for name, kind, unit in [("--speed-rpm", command_line.number, "rpm"), ("--normal-force", command_line.force, "N")]:
        parser.add_argument(
            name, type=kind, nargs=3, required=True, metavar=("FIRST", "LAST", "COUNT"), help=f"[{unit}]"
        )
    parser.add_argument("--stop", type=command_line.positive, default=60.0, help="length of a run [s]")
    parser.add_argument("--scheduler", help="address of a Dask scheduler; without it a cluster on this machine")
    parser.add_argument("--workers", type=command_line.count, default=2, help="processes of the cluster on this machine")
    parser.add_argument("--out", type=command_line.folder, required=True)
    arguments = parser.parse_args()

    points = points_of(parser, {"--speed-rpm": arguments.speed_rpm, "--normal-force": arguments.normal_force})
    if not same_study(arguments.out, arguments.fmu, arguments.stop):
        parser.error(f"{arguments.out} has the study of another FMU or another --stop; name another folder")
    path = arguments.out / "study.csv"
    local = None
    if arguments.scheduler is None:
        local = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    try:
        client = Client(arguments.scheduler or local)
    except (OSError, ValueError) as error:
        parser.error(f"no scheduler answers at {arguments.scheduler}: {error}")
    try:
        with client:
            study(client, arguments.fmu.read_bytes(), points, arguments.stop, path)
    except KilledWorker as error:
        sys.exit(f"study.py: workers keep dying: {error}; {path} has what is done, call again to go on")
    finally:
        if local is not None:
            local.close()
    table = pandas.read_csv(path).sort_values(["speed_rpm", "normal_force"])
    print(f"{len(table)} runs, {(table['stuck_share'] > 0).sum()} with sticking: {path}")
    picture(path, arguments.out)


if __name__ == "__main__":
    main()
