"""What the tests share."""

from __future__ import annotations

import subprocess
import sys

import pytest


@pytest.fixture
def command(tmp_path):
    """Runs the command `fsot` of the wheel in an empty folder, and gives back what it said."""

    def run(*arguments, code=0):
        done = subprocess.run(
            [sys.executable, "-m", "fsot", *map(str, arguments)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )
        assert done.returncode == code, done.stderr
        return done

    return run
