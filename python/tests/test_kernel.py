"""Kernels of given weights: the command's bits, the arrays that come back, refusals."""

from __future__ import annotations

import pickle

import numpy
import pytest

import fsot

TENT = numpy.array([[1.0, 2.0, 1.0], [2.0, 4.0, 2.0], [1.0, 2.0, 1.0]])
EVEN = numpy.arange(1.0, 9.0).reshape(2, 4)
OVER_TIME = numpy.stack([TENT, numpy.zeros((3, 3)), 0.5 * TENT + 0.25 * numpy.eye(3)])

# Weights, settings of the function, flags of the command.
SAME = {
    "odd": (TENT, {}, []),
    "even": (EVEN, {}, []),
    "whole numbers": (TENT.astype("u1"), {}, []),
    "of an animation": (TENT, dict(frames=5), ["--frames", 5]),
    "times a history": (EVEN, dict(frames=5, temporal="ema:0.2"), ["--frames", 5, "--temporal", "ema:0.2"]),
    "times weights": (TENT, dict(frames=5, temporal=[2, 1]), ["--frames", 5, "--temporal", "taps:2,1"]),
    "over frames": (OVER_TIME, dict(frames=5), ["--frames", 5]),
    "over more frames than there are": (OVER_TIME, dict(frames=2), ["--frames", 2]),
    "as large as the tile": (numpy.outer(*[numpy.arange(1.0, 17.0)] * 2), {}, []),
}


@pytest.mark.parametrize("name", SAME)
def test_bits_are_those_of_the_command(name, command, tmp_path):
    weights, settings, flags = SAME[name]
    numpy.save(tmp_path / "kernel.npy", weights)
    flags = flags if "--frames" in flags else [*flags, "--frames", 1]
    command(
        "table", "--width", 16, "--height", 16, *flags, "--kernel", "kernel.npy", "--sweeps", 4, "--no-bound",
        "--quiet",
    )
    theirs = fsot.Table.load(tmp_path / "table.npy")
    made = fsot.table(16, 16, **settings, kernel=weights, sweeps=4, progress=False)
    assert made == theirs
    assert made.metadata["configuration"] == theirs.metadata["configuration"]


@pytest.mark.parametrize("sides", [(1, 1), (3, 3), (2, 2), (4, 3), (3, 6), (1, 8), (7, 2)])
@pytest.mark.parametrize("frames", [1, 2, 5])
def test_arrays_come_back_from_taps(sides, frames):
    rows, columns = sides
    given = numpy.random.default_rng(3).uniform(0.1, 1, (frames, rows, columns))
    back = numpy.zeros_like(given)
    for dt, dy, dx, weight in fsot.Kernel(given).taps(10, 9, 6):
        # An odd side is centred, an even one reaches one pixel further right and down.
        back[int(-dt), int(dy) + (rows - 1) // 2, int(dx) + (columns - 1) // 2] = weight
    numpy.testing.assert_allclose(back, given / given.max(), rtol=1e-12)


FOREIGN = {
    "a list": TENT.tolist(),
    "float32": TENT.astype("f4"),
    "half": TENT.astype("f2"),
    "int64": TENT.astype("i8"),
    "bytes turned": TENT.astype(">f8"),
    "Fortran": numpy.asfortranarray(TENT),
    "mirrored": numpy.ascontiguousarray(TENT[::-1, ::-1])[::-1, ::-1],
    "every other one": numpy.repeat(numpy.repeat(TENT, 2, 0), 2, 1)[::2, ::2],
}


@pytest.mark.parametrize("name", FOREIGN)
def test_any_array_of_numbers_is_a_kernel(name):
    assert fsot.Kernel(FOREIGN[name]) == fsot.Kernel(TENT)


def test_an_array_is_read_and_not_kept():
    given = TENT.copy()
    given.flags.writeable = False
    kernel = fsot.Kernel(given)
    given.flags.writeable = True
    given[:] = 0
    assert kernel == fsot.Kernel(TENT)


def test_a_kernel_and_its_weights_make_the_same_table():
    def made(kernel, frames=1, **settings):
        return fsot.table(12, 12, frames, kernel=kernel, sweeps=3, progress=False, **settings)

    assert made(fsot.Kernel(TENT)) == made(TENT)
    assert made(fsot.Kernel(OVER_TIME), 4) == made(OVER_TIME, 4)
    # A kernel is taken as it is, weights in space are seen over time as is usual.
    eye = fsot.Kernel(TENT, temporal="perceptual:60")
    assert made(eye, 4) == made(TENT, 4) != made(fsot.Kernel(TENT), 4)
    assert made(fsot.Kernel(TENT), 4, temporal="perceptual:60") == made(eye, 4)


def test_known_families_are_their_weights():
    def taps(kernel):
        return sorted(map(tuple, numpy.round(kernel.taps(), 9)))

    assert taps(fsot.Kernel.binomial(3)) == taps(fsot.Kernel(TENT))
    assert taps(fsot.Kernel.box_(4)) == taps(fsot.Kernel(numpy.ones((4, 4))))
    y, x = numpy.mgrid[-7:8, -7:8]
    gaussian = numpy.exp(-(x**2 + y**2) / 2.1**2)
    assert taps(fsot.Kernel.gaussian(2.1)) == taps(fsot.Kernel(gaussian))


def test_truncation_drops_small_taps():
    kernel = fsot.Kernel.gaussian(2.1)
    assert kernel.truncation == 1e-3 and len(kernel.taps()) == 97
    coarse = kernel.with_truncation(0.5)
    assert coarse == fsot.Kernel.gaussian(2.1, truncation=0.5) and coarse.truncation == 0.5
    # exp(-r^2 / 2.1^2) >= 1/2 up to r^2 = 3.06: the pixel and its eight neighbours.
    assert len(coarse.taps()) == 9 and coarse.taps()[:, 3].min() >= 0.5
    assert fsot.Kernel([[1e-4, 1]], truncation=0).taps().shape == (2, 4)


def test_separate_is_two_kernels():
    space, time = fsot.Kernel(TENT, temporal="box:3", truncation=0.3).separate()
    assert space == fsot.Kernel(TENT, truncation=0.3)
    assert time == fsot.Kernel.box_(1, temporal="box:3", truncation=0.3)
    with pytest.raises(ValueError, match="weights for each frame: give weights"):
        fsot.Kernel(OVER_TIME).separate()


@pytest.mark.parametrize("weights", [TENT, EVEN, OVER_TIME])
def test_kernels_are_plain_data(weights):
    kernel = fsot.Kernel(weights, truncation=0.01)
    assert pickle.loads(pickle.dumps(kernel)) == kernel == fsot.Kernel.from_dict(kernel.to_dict())


BAD = {
    "negative": (numpy.array([[1, 2], [-3, 4]]), ValueError, r"weight -3 at \[y 1, x 0\]: weights must be"),
    "negative, over time": ([[[1.0]], [[-2.0]]], ValueError, r"weight -2 at \[frame 1, y 0, x 0\]"),
    "NaN": ([[1, numpy.nan]], ValueError, r"weight NaN at \[y 0, x 1\]"),
    "infinite": ([[numpy.inf]], ValueError, "weight inf"),
    "nothing": (numpy.zeros((3, 3)), ValueError, "sum is 0: give a sum that is above 0"),
    "beyond all numbers": ([[1.7e308, 1.7e308]], ValueError, "sum is inf"),
    "empty": (numpy.zeros((0, 3)), ValueError, "holds no weights: give at least one"),
    "a number": (2.0, ValueError, r"shape \[\]: give two axes"),
    "a line": ([1.0, 2.0], ValueError, r"shape \[2\]: give two axes \[y, x\] or three"),
    "four axes": (numpy.ones((1, 1, 1, 1)), ValueError, "give two axes"),
    "complex": (numpy.ones((2, 2), complex), TypeError, "complex128: give real numbers"),
    "words": ("kernel.npy", TypeError, "give real numbers"),
    "objects": ([[None]], TypeError, "give real numbers"),
    "ragged": ([[1, 2], [3]], TypeError, "give one that numpy.asarray takes"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_kernel_is_refused(name):
    weights, error, sentence = BAD[name]
    with pytest.raises(error, match=sentence):
        fsot.Kernel(weights)
    with pytest.raises(error, match=sentence):
        fsot.table(8, 8, kernel=weights, sweeps=1, progress=False)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: fsot.Kernel.gaussian(0), "sigma_px is 0: give a value above 0"),
        (lambda: fsot.Kernel.gaussian(-1.5), "sigma_px is -1.5"),
        (lambda: fsot.Kernel.gaussian(float("nan")), "sigma_px is NaN"),
        (lambda: fsot.Kernel.gaussian(float("inf")), "sigma_px is inf"),
        (lambda: fsot.Kernel.box_(0), "size_px is 0: give a value from 1"),
        (lambda: fsot.Kernel.box_(-2), "-2 is out of range: give"),
        (lambda: fsot.Kernel.box_(10**30), "out of range: give"),
        (lambda: fsot.Kernel.binomial(1001), "size_px is 1001: give a value from 1 to 1000"),
        (lambda: fsot.Kernel.gaussian(truncation=1), r"truncation is 1: give a value in \[0, 1\)"),
        (lambda: fsot.Kernel(TENT, truncation=-0.1), "truncation is -0.1"),
        (lambda: fsot.Kernel(TENT).with_truncation(float("nan")), "truncation is NaN"),
        (lambda: fsot.Kernel.gaussian(temporal="ema:2"), "alpha is 2"),
        (lambda: fsot.Kernel.gaussian(temporal="foo"), "'foo' is no temporal kernel: write none"),
        (lambda: fsot.Kernel.gaussian(temporal=[]), "no positive weight"),
        (lambda: fsot.Kernel.gaussian(temporal=[1, -1]), "weight -1 at tap 1"),
        (lambda: fsot.Kernel.gaussian(temporal=[[1, 2]]), r"shape \[1, 2\]: give a list of weights"),
        (lambda: fsot.Kernel(OVER_TIME, temporal="none"), "already: leave out the temporal kernel"),
        (lambda: fsot.Kernel(OVER_TIME).with_temporal([1]), "already: leave out the temporal kernel"),
        (lambda: fsot.Kernel(TENT).taps(0), "width is 0|the width"),
        (lambda: fsot.Kernel.from_dict({"spatial": {"gaussian": {"sigma_px": -1}}}), "sigma_px is -1"),
        (lambda: fsot.table(8, 8, sigma=1, kernel=TENT), "sigma and kernel say the same thing twice"),
        (lambda: fsot.table(8, 8, kernel=OVER_TIME, temporal="none"), "leave out the temporal kernel"),
        (
            lambda: fsot.table(8, 8, kernel=fsot.Kernel(TENT, temporal=[1, 1]), temporal="ema:0.1"),
            "both say how frames are seen",
        ),
        (lambda: fsot.table(8, 8, temporal=[[1.0]]), "the current frame first"),
    ],
)
def test_a_bad_argument_is_refused_before_any_work(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


@pytest.mark.parametrize("over_time", [False, True])
def test_a_kernel_larger_than_the_tile_is_refused_as_by_the_command(over_time, command, tmp_path):
    weights = numpy.ones((2, 3, 9) if over_time else (3, 9))
    numpy.save(tmp_path / "kernel.npy", weights)
    said = command("table", "--width", 8, "--height", 7, "--kernel", "kernel.npy", code=1).stderr
    words = "has 9 × 3 weights, more than the 8 × 7 pixels of a frame: give a smaller kernel, or"
    assert words in said
    for kernel in (weights, fsot.Kernel(weights)):
        with pytest.raises(ValueError, match=words):
            fsot.table(8, 7, kernel=kernel, sweeps=1, progress=False)


@pytest.mark.parametrize(
    "give",
    [
        lambda: fsot.Config(8, 8).with_kernel([[1.0, 2.0]]),
        lambda: fsot.Config(8, 8).with_kernels([numpy.ones((3, 3))]),
        lambda: fsot.Classes.lattice(None),
        lambda: fsot.metrics.filtered_error(numpy.full((1, 4, 4, 1, 2), 0.5), kernel=2.1),
    ],
)
def test_what_is_no_kernel_is_told_how_to_make_one(give):
    with pytest.raises(TypeError, match=r"is no Kernel: give one, as by fsot.Kernel\(weights\)"):
        give()
