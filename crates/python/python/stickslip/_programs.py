"""The programs that the package installs: the command lines of the native module, with their exit codes."""

from __future__ import annotations

import signal
import sys

from . import _native


def stickslip() -> int:
    """Run the program ``stickslip`` with the arguments of this process."""
    _leave_interrupts_alone()
    return _native.stickslip(["stickslip", *sys.argv[1:]])


def build_fmu() -> int:
    """Run the program ``build-fmu`` with the arguments of this process."""
    _leave_interrupts_alone()
    return _native.build_fmu(["build-fmu", *sys.argv[1:]])


def _leave_interrupts_alone() -> None:
    """Let Ctrl-C end the process, or do what the program itself makes of it: Python's own handler would wait for Python."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
