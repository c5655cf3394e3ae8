"""``python -m fsot`` is the command ``fsot``."""

from __future__ import annotations

import sys

from ._fsot import command as _command


def command() -> None:
    """Runs the command with the arguments of this process."""
    sys.exit(_command(["fsot", *sys.argv[1:]]))


if __name__ == "__main__":
    command()
