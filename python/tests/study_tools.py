"""What tests of studies share."""

import signal
import sys
from pathlib import Path

import pytest

pytest.importorskip("distributed")
pytest.importorskip("filelock")
EXAMPLES = Path(__file__).parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

import study  # noqa: E402
from studies import results  # noqa: E402

GRID = """
[kernels]
wide = { sigma = 2.1 }
box = { box = 3 }
[[grid]]
kernel = ["wide", "box"]
width = 16
height = 8
seeds = 3
sweeps = [2, 8]
[measure]
integrands = 4
slices = 64
"""
#: What a row says of a table, and not of where and when it was made.
FACTS = [
    column
    for column in results.COLUMNS
    if column not in ("seconds", "task_seconds", "finished", "host", "pid", "worker")
]


@pytest.fixture(autouse=True)
def signals():
    """The command takes SIGTERM for itself."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def toml(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(GRID)
    return path


def run(toml, *arguments):
    """The command, with a CSV file beside the grid."""
    return study.main(
        [str(toml), "--out", str(toml.with_suffix(".csv")), "--no-plot", "--serial", *arguments]
    )


def facts(path):
    return {key: {column: row[column] for column in FACTS} for key, row in results.load(path).items()}


def lines(toml):
    return toml.with_suffix(".csv").read_bytes().count(b"\n")
