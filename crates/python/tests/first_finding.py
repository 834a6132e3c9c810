"""What somebody who has just installed the package does first: load a case and ask what its model lacks."""

import pathlib
import sys

import stickslip

if __name__ == "__main__":
    finding = stickslip.Case.from_directory(pathlib.Path(sys.argv[1])).diagnose(progress=False)
    print(finding)
    assert finding.verdict == "named" and [effect.name for effect in finding.effects] == ["unbalance"]
