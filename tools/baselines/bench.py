"""Scores the baselines on a directory of cases: `python bench.py CASES --out OUT`."""

import argparse
import json
import os
import sys
import time
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import pandas as pd
from methods import METHODS, run
from residuals import problem

SUFFIXES = ("_braked", "_no_brake", "_gauss", "_c")
SHORT = {"wobble": "normal_force_wobble", "bearing": "bearing_friction"}


def hidden_effects(kind):
    """Names behind a `kind` of ANSWERS.json; empty for a clean case or one in no catalogue."""
    if kind.startswith(("none", "outside_")):
        return []
    names = kind.split("_and_")
    for suffix in SUFFIXES:
        names = [name.removesuffix(suffix) for name in names]
    return [SHORT.get(name, name) for name in names]


def group_of(answer):
    kind = answer["kind"]
    if kind.startswith("none"):
        return "clean"
    if kind.startswith("outside_"):
        return "outside"
    if "_and_" in kind:
        return "pair"
    if answer["rough"] > 0:
        return "rough"
    if answer["scale"] < 0.25:
        return "small"
    return "full" if 0.55 <= answer["scale"] <= 1.45 else "other"


def score(cases: Path):
    """A row per case and method, and one more per single effect with that effect taken out of the library."""
    answers = json.loads((cases / "ANSWERS.json").read_text())
    rows = []
    for index, (case, answer) in enumerate(answers.items(), start=1):
        print(f"\r{index}/{len(answers)} {case:40}", end="", file=sys.stderr, flush=True)
        truth = hidden_effects(answer["kind"])
        start = time.perf_counter()
        whole = problem(cases / case)
        shared = time.perf_counter() - start
        for without in (False, True) if len(truth) == 1 else (False,):
            regression = whole.without(truth) if without else whole
            for method in METHODS:
                start = time.perf_counter()
                named = run(method, regression)
                rows.append({
                    "case": case, "kind": answer["kind"], "group": group_of(answer), "method": method,
                    "without": without, "named": " ".join(named),
                    "top1": not without and named[:1] != [] and named[0] in truth,
                    "exact": sorted(named) == sorted([] if without else truth), "named_something": bool(named),
                    "seconds": shared + time.perf_counter() - start,
                })
    print(file=sys.stderr)
    return pd.DataFrame(rows)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("cases", type=Path, help="directory with ANSWERS.json")
    arguments.add_argument("--out", type=Path, default=Path("out"), help="where baselines.csv and .json go")
    given = arguments.parse_args()
    if not (given.cases / "ANSWERS.json").exists():
        print(f"{given.cases}: no ANSWERS.json here", file=sys.stderr)
        return 2
    table = score(given.cases)
    summary = table.groupby(["without", "group", "method"], sort=True).agg(
        cases=("case", "count"), top1=("top1", "sum"), exact=("exact", "sum"),
        named_something=("named_something", "sum"), seconds=("seconds", "mean"),
    )
    print(table[~table.without].pivot(index=["case"], columns="method", values="named").to_string())
    print()
    print(summary.round(2).to_string())
    given.out.mkdir(parents=True, exist_ok=True)
    for name, text in (
        ("baselines.csv", table.to_csv(index=False)),
        ("baselines.json", json.dumps(summary.reset_index().to_dict("records"), indent=1)),
    ):
        partial = given.out / f".partial-{name}"
        partial.write_text(text)
        partial.replace(given.out / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
