"""Sets the baselines beside `stickslip score` on the same cases: `python compare.py CASES --score DIR --baselines DIR`.

Reads the findings that `stickslip score CASES --out DIR [--leave-one-out]` left and the table of `bench.py`, judges all by
the same rules, and writes comparison.md into the baselines' directory.
"""

import argparse
import json
import sys
from pathlib import Path

import pandas as pd
from bench import group_of, hidden_effects

OURS = "stickslip"
# Nearly a change of parameters where no current is measured: to name nothing is right for them, whoever says it.
NEARLY_PARAMETERS = {"motor_viscous", "supply_sag"}
GROUPS = ["full", "rough", "small", "other", "pair", "clean", "outside"]


def our_names(finding):
    """Names in a finding, the one it trusts most first; of several that cannot be told apart all count as said."""
    return [effect["name"] for effect in finding["effects"]] + [
        name for name in finding["alternatives"] if name not in {effect["name"] for effect in finding["effects"]}
    ]


def our_rows(answers, score):
    """One row per case that `stickslip score` has diagnosed, and one per case with its effect taken out."""
    rows = []
    for folder, without in ((score, False), (score / "leave-one-out", True)):
        for case in answers:
            path = folder / case / "finding.json"
            if path.exists():
                finding = json.loads(path.read_text())
                rows.append({
                    "case": case, "method": OURS, "without": without, "names": our_names(finding),
                    "verdict": finding["verdict"], "seconds": finding["seconds"],
                })
    return rows


def baselines_rows(table):
    return [
        {
            "case": row.case, "method": row.method, "without": bool(row.without), "names": str(row.named).split(),
            "verdict": "named" if str(row.named).split() else "parameters", "seconds": row.seconds,
        }
        for row in table.fillna({"named": ""}).itertuples()
    ]


def judged(row, answer):
    truth = hidden_effects(answer["kind"])
    quiet = row["verdict"] in ("nothing_missing", "parameters")
    accepted = quiet and len(truth) == 1 and truth[0] in NEARLY_PARAMETERS
    group = group_of(answer)
    names = row["names"]
    return {
        **row,
        "group": group,
        "top-1": accepted or names[:1] != [] and names[0] in truth,
        "exact set": accepted or row["verdict"] == "named" and sorted(names) == sorted(truth),
        "wrong name": row["verdict"] == "named" and any(name not in truth for name in names),
        "flagged": row["verdict"] == "not_in_catalogue",
        "alarm": not quiet,
    }


def measures(frame):
    """Lines of the table: (what, cases it is over, column, whether more is better)."""
    for group in GROUPS:
        part = frame[(frame.group == group) & ~frame.without]
        if part.empty:
            continue
        if group == "clean":
            yield "nothing hidden: alarms", part, "alarm", False
        elif group == "outside":
            yield "in no catalogue: wrong name", part, "wrong name", False
            yield "in no catalogue: flagged", part, "flagged", True
        elif group == "pair":
            yield "two effects: both, nothing else", part, "exact set", True
        else:
            yield f"one effect, {group}: top-1", part, "top-1", True
            yield f"one effect, {group}: exactly it", part, "exact set", True
            yield f"one effect, {group}: wrong name", part, "wrong name", False
    out = frame[frame.without & ~frame.nearly]
    if not out.empty:
        yield "right effect taken out: wrong name", out, "wrong name", False
        yield "right effect taken out: flagged", out, "flagged", True


def markdown(frame, methods):
    others = [method for method in methods if method != OURS]
    lines = ["| | " + " | ".join(methods) + " | as good or better than stickslip |", "|---" * (len(methods) + 2) + "|"]
    for what, part, column, more in measures(frame):
        counts = {method: part[part.method == method] for method in methods}
        cells = [f"{int(c[column].sum())} of {len(c)}" if len(c) else "–" for c in counts.values()]
        ours = counts[OURS]
        rivals = []
        for method in others:
            theirs = counts[method]
            if len(ours) and len(theirs):
                gain = theirs[column].mean() - ours[column].mean()
                if gain == 0 or (gain > 0) == more:
                    rivals.append(method + (" (as good)" if gain == 0 else " (better)"))
        lines.append(f"| {what} | " + " | ".join(cells) + " | " + (", ".join(rivals) or "none") + " |")
    whole = frame[~frame.without]
    seconds = {method: whole[whole.method == method].seconds.median() for method in methods}
    faster = [f"{method} (better)" for method in others if seconds[method] < seconds[OURS]]
    cells = [f"{seconds[method]:.1f}" for method in methods]
    lines.append("| seconds per case, median | " + " | ".join(cells) + " | " + (", ".join(faster) or "none") + " |")
    lines.append("| numbers with intervals, amended model, held-out gap | yes | " + " | ".join("no" for _ in others) + " | none |")
    return "\n".join(lines) + "\n"


def lost_cases(frame, methods):
    """Cases in which a baseline is right and stickslip is not."""
    right = frame[~frame.without & ~frame.group.isin(["clean", "outside"])].pivot(index="case", columns="method", values="exact set")
    lines = []
    for case, row in right.iterrows():
        better = [method for method in methods if method != OURS and row.get(method) is True or method != OURS and row.get(method) == 1]
        if not row.get(OURS) and better:
            lines.append(f"- {case}: {', '.join(better)}")
    return "\n".join(lines) + "\n" if lines else "None.\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("cases", type=Path, help="directory with ANSWERS.json")
    arguments.add_argument("--score", type=Path, required=True, help="what `stickslip score` wrote")
    arguments.add_argument("--baselines", type=Path, required=True, help="what bench.py wrote")
    given = arguments.parse_args()
    answers = json.loads((given.cases / "ANSWERS.json").read_text())
    ours = our_rows(answers, given.score)
    if not ours:
        print(f"{given.score}: no findings; run `stickslip score {given.cases} --out {given.score}` first", file=sys.stderr)
        return 2
    path = given.baselines / "baselines.csv"
    if not path.exists():
        print(f"{path}: not there; run bench.py first", file=sys.stderr)
        return 2
    theirs = baselines_rows(pd.read_csv(path))
    # Only cases that all have done are compared.
    done = {(row["case"], row["without"]) for row in ours}
    rows = ours + [row for row in theirs if (row["case"], row["without"]) in done]
    frame = pd.DataFrame([judged(row, answers[row["case"]]) for row in rows])
    frame["nearly"] = [set(hidden_effects(answers[case]["kind"])) <= NEARLY_PARAMETERS for case in frame.case]
    methods = [OURS] + sorted(frame[frame.method != OURS].method.unique())
    text = (
        "# stickslip and its baselines\n\n"
        "All got model and records alone, the same catalogue and the same uncertainty of the nominal parameters; the "
        "baselines' regressions have the parameters projected out. stickslip uses all cores, the baselines one.\n\n"
        f"{markdown(frame, methods)}\n"
        f"## Cases that a baseline gets exactly right and stickslip does not\n\n{lost_cases(frame, methods)}"
    )
    partial = given.baselines / ".partial-comparison.md"
    partial.write_text(text)
    partial.replace(given.baselines / "comparison.md")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
