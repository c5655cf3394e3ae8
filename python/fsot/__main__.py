"""``python -m fsot`` is the command ``fsot``."""

from __future__ import annotations

import signal
import sys

from ._fsot import command as _command


def command() -> None:
    """Runs the command with the arguments of this process, and ends the process with its exit code."""
    # Python hears Ctrl-C between its own instructions, of which there are none until the command is done. The
    # command listens for itself when it has something to keep; until then signals kill, as they do elsewhere.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_command(["fsot", *sys.argv[1:]]))


if __name__ == "__main__":
    command()
