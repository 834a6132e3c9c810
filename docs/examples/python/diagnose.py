"""What a model lacks, from records of the rig: the finding, its figures, the amended model with its FMUs.

    python diagnose.py model.toml run-a.csv run-b.csv --held-out held-out.csv --out out/python

Records are CSV files here; docs/tables.md reads those of other programs. Exit code 1: structure is left.
"""

import sys

import command_line
import stickslip

parser = command_line.parser(__doc__)
parser.add_argument("model", type=command_line.model)
parser.add_argument("records", nargs="+", help="to learn from: FILE, or FILE@FROM:TO in seconds")
parser.add_argument("--held-out", help="to judge on; without it the last record, or the last quarter of a single one")
parser.add_argument("--out", type=command_line.folder, required=True)
arguments = parser.parse_args()

try:
    case = stickslip.Case(arguments.model, arguments.records, arguments.held_out)
    for note in case.notes:
        print(f"note: {note}")
    finding = case.diagnose(out=arguments.out)
except stickslip.InputError as error:
    parser.error(str(error))
finding.figure().savefig(arguments.out / "held-out.png", dpi=120)
finding.candidates_figure().savefig(arguments.out / "candidates.png", dpi=120)

print(finding)
print(f"{finding.report}, and beside it: {', '.join(path.name for path in finding.fmus)}, held-out.png, candidates.png")
sys.exit(0 if finding.is_settled else 1)
