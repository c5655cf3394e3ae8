"""The examples, run briefly: what they print says that they work."""

import pathlib
import subprocess
import sys

import numpy
import pytest

import fsot

pytest.importorskip("torch")
EXAMPLES = pathlib.Path(__file__).parent.parent / "examples"


def lines(example, *arguments):
    """What an example prints, by the names at the beginning of its lines."""
    run = subprocess.run(
        [sys.executable, EXAMPLES / example, *arguments], capture_output=True, text=True, timeout=300
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.splitlines()


def test_adam_makes_a_table(tmp_path):
    path = tmp_path / "table.npy"
    printed = lines("adam_table.py", "--size", "8", "--steps", "80", "--out", str(path))
    names = [line[:36].split(",")[0].strip() for line in printed[1:]]
    figures = dict(zip(names, ([float(figure) for figure in line[36:].split()] for line in printed[1:])))
    assert figures["white noise"][1:3] == [1, 1]
    assert figures["Adam"][1] < 0.5 and figures["fsot"][1] < 0.5
    table = fsot.Table.load(path)
    assert table.shape == (1, 8, 8, 1, 2)
    objective = fsot.Objective(fsot.Config(8, 8))
    assert objective.cramer(table)[0] < 0.5 * objective.cramer(numpy.random.default_rng(0).random((64, 2)))[0]


def test_a_network_learns_and_keeps_what_it_has_learnt_on_new_noise(tmp_path):
    path = tmp_path / "table.npy"
    printed = lines("train_network.py", "--size", "16", "--steps", "250", "--out", str(path))
    errors = {line[:24].strip(): float(line[24:].split()[0]) for line in printed[2:]}
    for size in ("16 x 16", "32 x 32"):
        assert 0.6 < errors[f"{size}, white noise"] < 1.5
        assert errors[f"{size}, network"] < 0.9 * errors[f"{size}, white noise"]
        assert errors[f"{size}, fsot"] < errors[f"{size}, network"]
    assert fsot.Table.load(path).shape == (1, 16, 16, 1, 2)
