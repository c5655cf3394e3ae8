"""`fsot.table`: the same bits as the command's, refusals in the library's own words."""

from __future__ import annotations

import json

import numpy
import pytest

import fsot

# Settings of the function and flags of the command that say the same.
SAME = {
    "usual": (dict(sweeps=20), ["--sweeps", 20]),
    "wide": (dict(width=24, height=16, sweeps=10), ["--width", 24, "--height", 16, "--sweeps", 10]),
    "animation": (dict(frames=6, sweeps=4), ["--frames", 6, "--sweeps", 4]),
    "history": (
        dict(frames=6, temporal="ema:0.2", sweeps=4),
        ["--frames", 6, "--temporal", "ema:0.2", "--sweeps", 4],
    ),
    "samples": (dict(spp=3, dims=4, sweeps=6), ["--spp", 3, "--dims", 4, "--sweeps", 6]),
    "scalar": (dict(dims=1, sweeps=30), ["--dims", 1, "--sweeps", 30]),
    "width of the filter": (dict(sigma=1.2, seed=9, sweeps=10), ["--sigma", 1.2, "--seed", 9, "--sweeps", 10]),
    "groups": (
        dict(dims=4, groups=[[0, 1], ([2, 3], 0.5)], sweeps=6),
        ["--dims", 4, "--groups", "0,1;2,3:0.5", "--sweeps", 6],
    ),
    "slices": (dict(slices=32), ["--slices-per-class", 32]),
    "slices, then sweeps": (dict(slices=16, sweeps=4), ["--slices-per-class", 16, "--sweeps", 4]),
    "torus": (dict(domain="torus", slices=16), ["--domain", "torus", "--slices-per-class", 16]),
    "an amount of work that is usual": (dict(width=8, height=8), ["--width", 8, "--height", 8]),
}


@pytest.mark.parametrize("name", SAME)
def test_bits_are_those_of_the_command(name, command, tmp_path):
    settings, flags = SAME[name]
    settings = dict(width=16, height=16) | settings
    if "--width" not in flags:
        flags = [*flags, "--width", 16, "--height", 16]
    if "--frames" not in flags:
        flags = [*flags, "--frames", 1]
    command("table", *flags, "--no-bound", "--quiet", "--out", "table.npy")
    made = fsot.table(**settings, progress=False)
    theirs = fsot.Table.load(tmp_path / "table.npy")
    assert made == theirs
    # All but the time.
    for metadata in (mine := dict(made.metadata), its := dict(theirs.metadata)):
        metadata["run"] = {key: value for key, value in metadata["run"].items() if key != "seconds"}
    assert mine == its


def test_a_domain_for_each_dimension(command, tmp_path):
    (tmp_path / "mixed.toml").write_text('width = 16\nheight = 16\nframes = 1\ndomain = ["torus", "interval"]\n')
    command("table", "--config", "mixed.toml", "--slices-per-class", 16, "--no-bound", "--out", "table.npy")
    made = fsot.table(16, 16, domain=["torus", "interval"], slices=16, progress=False)
    assert made == fsot.Table.load(tmp_path / "table.npy")


def test_a_saved_table_can_be_made_again_by_the_command(command, tmp_path):
    fsot.table(16, 16, 4, sigma=1.5, sweeps=5, progress=False).save(tmp_path / "mine.npy")
    command("table", "--config", "mine.json", "--no-bound", "--quiet", "--out", "again.npy")
    assert fsot.Table.load(tmp_path / "again.npy") == fsot.Table.load(tmp_path / "mine.npy")


def test_numbers_lie_below_one_and_hold_the_exact_grid():
    table = fsot.table(16, 16, spp=2, sweeps=10, progress=False)
    assert table.array.dtype == numpy.float32 and table.array.shape == (1, 16, 16, 2, 2)
    # A finished run of sweeps ends with exact ranks: (rank + 1/2) / 512 in each coordinate.
    for dim in range(2):
        column = numpy.sort(table.array[..., dim].ravel())
        assert numpy.allclose(column, (numpy.arange(512) + 0.5) / 512, atol=1e-6)


def test_seeds_are_other_tables():
    tables = [fsot.table(16, 16, sweeps=2, seed=seed, progress=False) for seed in (0, 1, 2**64 - 1)]
    assert tables[0] != tables[1] != tables[2] and tables[2].metadata["seed"] == 2**64 - 1


def test_numpys_numbers_are_numbers():
    made = fsot.table(
        numpy.int64(16), numpy.uint8(16), spp=numpy.int32(2), sigma=numpy.float32(2.0), seed=numpy.uint64(3),
        sweeps=numpy.int16(2), progress=False,
    )
    assert made == fsot.table(16, 16, spp=2, sigma=2.0, seed=3, sweeps=2, progress=False)


@pytest.mark.parametrize(
    ("settings", "error", "sentence"),
    [
        (dict(width=0), ValueError, "width"),
        (dict(width=-3), ValueError, "-3 is out of range: give a whole number"),
        (dict(width=2**70), ValueError, "out of range: give a"),
        (dict(width=2**31), ValueError, "."),
        (dict(height=1.5), TypeError, "."),
        (dict(height="16"), TypeError, "."),
        (dict(height=True), TypeError, "True is no whole number"),
        (dict(height=None), TypeError, "."),
        (dict(dims=0), ValueError, "dim"),
        (dict(dims=65), ValueError, "64"),
        (dict(spp=0), ValueError, "spp"),
        (dict(frames=0), ValueError, "frames"),
        (dict(seed=-1), ValueError, "2\\*\\*64 - 1"),
        (dict(seed=2**64), ValueError, "2\\*\\*64 - 1"),
        (dict(seed=0.5), TypeError, "."),
        (dict(sigma=0.0), ValueError, "sigma"),
        (dict(sigma=float("nan")), ValueError, "sigma"),
        (dict(sigma="wide"), TypeError, "."),
        (dict(temporal="emma:0.1"), ValueError, "write none, gaussian:SIGMA"),
        (dict(temporal="ema:2"), ValueError, "alpha"),
        (dict(temporal=[]), ValueError, "temporal kernel"),
        (dict(temporal=[1.0, -0.5]), ValueError, "temporal kernel"),
        (dict(temporal=object()), TypeError, "."),
        (dict(domain="cube"), ValueError, "write interval or torus"),
        (dict(domain=["torus"]), ValueError, "one domain per dimension"),
        (dict(domain=3), TypeError, "."),
        (dict(groups=[]), ValueError, "."),
        (dict(groups=[[0, 0]]), ValueError, "dimension 0"),
        (dict(groups=[[0, 2]]), ValueError, "dimension 2"),
        (dict(groups=[[]]), ValueError, "."),
        (dict(groups=[([0, 1], -1.0)]), ValueError, "weight"),
        (dict(groups=[[-1]]), ValueError, "."),
        (dict(groups=3), TypeError, "."),
        (dict(groups=["01"]), TypeError, "."),
        (dict(sweeps=10**10), ValueError, "1e9|1000000000"),
        (dict(sweeps=-1), ValueError, "."),
        (dict(sweeps=2.5), TypeError, "."),
        (dict(seconds="1"), TypeError, "."),
        (dict(domain="torus", sweeps=3), ValueError, "use slices"),
        (dict(sigma=2.0, kernel=fsot.Kernel.gaussian(1.0)), ValueError, "leave out one of them"),
        (dict(nonsense=1), TypeError, "nonsense"),
    ],
)
def test_what_cannot_be_is_refused(settings, error, sentence):
    settings = dict(width=8, height=8, progress=False) | settings
    if "sweeps" not in settings and "seconds" not in settings:
        settings["sweeps"] = 1
    with pytest.raises(error, match=sentence):
        fsot.table(**settings)


def test_a_number_may_say_anything_of_itself():
    class Long(int):
        def __str__(self):
            return "é" * 50

    with pytest.raises(ValueError, match="é{20}... is out of range"):
        fsot.table(8, 8, seed=Long(-1))


def test_no_memory_is_refused_in_words():
    # 2^31 - 1 values are the most of a table; few machines hold what their optimiser takes.
    with pytest.raises((ValueError, MemoryError), match="."):
        fsot.table(40_000, 40_000, 1, 1, 2, sweeps=1, progress=False)


def test_metadata_are_plain_data():
    metadata = fsot.table(8, 8, sweeps=1, progress=False).metadata
    assert json.loads(json.dumps(metadata)) == metadata
    assert metadata["shape"] == [1, 8, 8, 1, 2] and metadata["run"]["sweeps"] == 1
