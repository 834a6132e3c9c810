"""``python -m stickslip``: the program ``stickslip``."""

import sys

from ._programs import stickslip

if __name__ == "__main__":
    sys.exit(stickslip())
