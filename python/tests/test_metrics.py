"""Metrics: known answers, twins in numpy, the same figures for every kind of array, refusals."""

from __future__ import annotations

import json
import math
import multiprocessing
import pickle
import threading
import warnings

import numpy
import pytest

import fsot
from fsot import metrics
from fsot.metrics import Integrand, Integrands

# Sums in another order than the library's.
ROUNDING = 1e-9
SHAPE = (3, 8, 10, 2, 3)


@pytest.fixture(scope="module")
def noise():
    return numpy.random.default_rng(1).random(SHAPE, dtype=numpy.float32)


@pytest.fixture(scope="module")
def integrands():
    return Integrands.random(2, 8, 3)


def linear(dims=2):
    return Integrand(lambda x: x.sum(axis=1), dims, dims / 2, dims / 12)


# Twins


def errors_of(array, integrand, dims):
    frames, height, width, spp, _ = array.shape
    points = array[..., dims].astype(numpy.float64).reshape(-1, len(dims))
    values = integrand(points).reshape(frames, height, width, spp)
    return values.mean(axis=3) - integrand.integral


def test_an_error_image_is_the_mean_less_the_integral(noise):
    for integrand in Integrands.random(2, 4, 5).families["ball"]:
        image = metrics.error_image(noise, integrand, dims=[2, 0])
        assert image.errors.shape == SHAPE[:3]
        numpy.testing.assert_allclose(image.errors, errors_of(noise, integrand, [2, 0]), atol=1e-12)
        assert image.white_variance == pytest.approx(integrand.variance / 2, rel=ROUNDING)


def test_filtered_errors_are_those_of_a_plain_convolution(noise, integrands):
    kernel = fsot.Kernel.gaussian(1.3, temporal="taps:0.6,0.3,0.1")

    def smoothed(image, kernel):
        taps = kernel.taps(width=10, height=8, frames=3)
        shares = taps[:, 3] / taps[:, 3].sum()
        moved = (
            numpy.roll(image, (-int(dt), -int(dy), -int(dx)), axis=(0, 1, 2)) * share
            for (dt, dy, dx, _), share in zip(taps, shares)
        )
        return sum(moved), (shares**2).sum()

    found = metrics.filtered_error(noise, dims=[0, 2], integrands=integrands, kernel=kernel)
    stages = {
        "unfiltered": lambda image: (image, 1.0),
        "spatial": lambda image: smoothed(image, fsot.Kernel.gaussian(1.3)),
        "spatio_temporal": lambda image: smoothed(image, kernel),
    }
    for stage, smooth in stages.items():
        means = {}
        for family, members in integrands.families.items():
            ratios = []
            for integrand in members:
                image, white = smooth(errors_of(noise, integrand, [0, 2]))
                ratios.append((image**2).mean() / (integrand.variance / 2 * white))
            means[family] = (numpy.mean(ratios), numpy.std(ratios, ddof=1) / math.sqrt(len(ratios)))
        ratios = getattr(found, stage)
        for family, (mean, error) in means.items():
            assert ratios.families[family].mean == pytest.approx(mean, rel=ROUNDING)
            assert ratios.families[family].standard_error == pytest.approx(error, rel=1e-6)
        assert ratios.mean == pytest.approx(numpy.mean([mean for mean, _ in means.values()]), rel=ROUNDING)


def test_biases_are_squared_errors_of_means(noise, integrands):
    found = metrics.bias(noise, dims=[1, 2], integrands=integrands)
    for family, members in integrands.families.items():
        table, frame, pixel = [], [], []
        for integrand in members:
            errors = errors_of(noise, integrand, [1, 2])
            table.append(errors.mean() ** 2 * 480 / integrand.variance)
            frame.append((errors.mean(axis=(1, 2)) ** 2).mean() * 160 / integrand.variance)
            pixel.append((errors**2).mean() * 2 / integrand.variance)
        for name, ratios in (("table", table), ("frame", frame), ("pixel", pixel)):
            mean = getattr(found, name).families[family].mean
            assert mean == pytest.approx(numpy.mean(ratios), rel=1e-6), (family, name)
    whole = metrics.set_error(noise, dims=[1, 2], integrands=integrands)
    assert whole.mean == pytest.approx(found.table.mean, rel=1e-9)


def test_spectra_are_those_of_numpys_transform(noise):
    integrand = linear()
    integrands = Integrands({"linear": [integrand]})
    found = metrics.spectra(noise, dims=[0, 1], integrands=integrands)
    errors = errors_of(noise, integrand, [0, 1]) / math.sqrt(integrand.variance / 2)
    power = numpy.abs(numpy.fft.fft2(errors, axes=(1, 2))) ** 2 / 80
    numpy.testing.assert_allclose(found.xy, numpy.fft.fftshift(power.mean(axis=0)), rtol=1e-8, atol=1e-12)
    power = numpy.abs(numpy.fft.fft2(errors, axes=(0, 2))) ** 2 / 30
    expected = numpy.fft.fftshift(power.mean(axis=1), axes=(0, 1))
    numpy.testing.assert_allclose(found.xt, expected, rtol=1e-8, atol=1e-12)
    assert found.fx.tolist() == pytest.approx(numpy.fft.fftshift(numpy.fft.fftfreq(10)).tolist())
    assert found.fy.tolist() == pytest.approx(numpy.fft.fftshift(numpy.fft.fftfreq(8)).tolist())
    assert found.ft.tolist() == pytest.approx(numpy.fft.fftshift(numpy.fft.fftfreq(3)).tolist())
    assert found.radial.count.sum() == 79
    assert (found.radial.power * found.radial.count).sum() == pytest.approx(
        found.xy.sum() - found.xy[4, 5], rel=ROUNDING
    )


def test_the_spectrum_of_a_wave_is_one_frequency():
    x = numpy.arange(16)
    spectra = metrics.spectra_of_image(numpy.tile(numpy.cos(2 * numpy.pi * 3 * x / 16), (16, 1)))
    found = {(spectra.fy[row], spectra.fx[column]) for row, column in numpy.argwhere(spectra.xy > 1e-9)}
    assert found == {(0, 3 / 16), (0, -3 / 16)}
    assert spectra.xy.max() == pytest.approx(128)
    assert spectra.anisotropy[0].along_y_over_along_x == pytest.approx(0, abs=1e-12)


# Known answers


def grid(n):
    centres = (numpy.arange(n) + 0.5) / n
    return numpy.stack(numpy.meshgrid(centres, centres), axis=-1).reshape(-1, 2)


def test_the_discrepancy_of_a_regular_grid_is_the_textbooks():
    n = 16
    x = grid(n)
    count = len(x)
    # Warnock's formula, as it is printed.
    single = ((1 - x**2) / 2).prod(axis=1).sum()
    pairs = (1 - numpy.maximum(x[:, None], x[None])).prod(axis=2).sum()
    expected = 3.0**-2 - 2 / count * single + pairs / count**2
    found = metrics.discrepancy(x)
    assert found.squared == pytest.approx(expected, rel=1e-9)
    assert found.ratio == pytest.approx(expected * count / (1 / 4 - 1 / 9), rel=1e-9)
    # In one dimension it is 1 / (12 n²).
    line = metrics.discrepancy(((numpy.arange(n) + 0.5) / n)[:, None])
    assert line.squared == pytest.approx(1 / (12 * n**2), rel=1e-9)


def test_a_grid_fills_its_cells_evenly():
    histogram = metrics.histogram(grid(16), cells_per_side=4)
    assert histogram.counts.tolist() == [[16] * 4] * 4 and histogram.spread == 0
    marginal = metrics.marginal(grid(16), 1, 8)
    assert marginal.counts.tolist() == [32] * 8 and marginal.zeros == 0
    # The first centre is at 1/32: nothing lies next to the faces.
    assert [face.density for face in marginal.faces] == [0] * 4
    assert metrics.histogram([[0.1, 0.9]], cells_per_side=2).counts.tolist() == [[0, 0], [1, 0]]


def test_white_noise_is_one():
    noise = numpy.random.default_rng(7).random((1, 64, 64, 1, 2), dtype=numpy.float32)
    error = metrics.filtered_error(noise)
    # 4096 pixels, of which the filter leaves some 300 independent ones.
    assert error.unfiltered.mean == pytest.approx(1, abs=0.05)
    assert error.spatial.mean == pytest.approx(1, abs=0.2)
    assert error.spatial == error.spatio_temporal
    bound = metrics.bound(noise)
    assert bound.ratio == pytest.approx(1, abs=5 * bound.ratio_standard_error + 0.02)
    assert metrics.spectra(noise).low_frequency_share() == pytest.approx(1, abs=0.3)


def test_a_table_is_better_than_white_noise_by_what_the_readme_says():
    table = fsot.table(64, 64, sweeps=20, progress=False)
    assert metrics.filtered_error(table).spatial.mean == pytest.approx(0.202, abs=0.01)
    assert metrics.bound(table).ratio == pytest.approx(0.646, abs=0.01)


def test_a_centre_is_as_far_from_the_square_as_the_square_is_wide():
    assert metrics.sliced_distance([[0.5, 0.5]]) == pytest.approx(12**-0.5, rel=1e-12)
    # All of a picture's mass in its left half: twice as near along x.
    left = numpy.zeros((8, 8))
    left[:, :4] = 1
    assert metrics.sliced_distance([[0.25, 0.5]], target=left) == pytest.approx(
        math.sqrt((1 / 12 + 1 / 48) / 2), rel=1e-3
    )


def test_targets_may_be_targets():
    target = fsot.Target.density([[1.0, 3.0]])
    points = grid(8)
    assert metrics.sliced_distance(points, target=target) == metrics.sliced_distance(points, target=[[1, 3]])
    assert metrics.sliced_distance(points, target=fsot.Target.uniform()) == metrics.sliced_distance(points)
    assert metrics.density_match(points, target) == metrics.density_match(points, [[1, 3]])


def test_points_in_the_dark_are_strays():
    left = numpy.zeros((1, 8))
    left[0, :4] = 1
    assert metrics.density_match([[0.1, 0.5], [0.4, 0.2], [0.9, 0.5]], left, 0.1).strays == 1
    # Half of the mass is in one pixel of 64, and a quarter of 400 points.
    bright = numpy.ones((8, 8))
    bright[2, 4] = 63
    spread = [[i % 20 / 20, i // 20 / 15] for i in range(300)]
    worst = metrics.density_match([*spread, *[[0.55, 0.3]] * 100], bright, 0.1).worst
    assert (worst.column, worst.row, worst.side, worst.expected) == (4, 2, 1, 200)
    assert worst.deviation < -9 and worst.points < 110
    even = metrics.density_match(grid(16), numpy.ones((16, 16)), 0.1)
    assert even.strays == 0 and even.correlation == pytest.approx(1)


def test_the_bound_of_a_configuration_is_that_of_its_run():
    config = fsot.Config(16, 16, seed=4)
    optimizer = fsot.Optimizer(config)
    before = metrics.bound(optimizer.points, config)
    optimizer.run(fsot.Until.sweeps(20), progress=False)
    after = metrics.bound(optimizer.table(), config)
    assert before.ratio == pytest.approx(1, abs=0.1)
    assert after.ratio < 0.75 * before.ratio
    assert len(after.terms) == len(config.to_dict()["terms"])
    assert metrics.bound(optimizer.table(), fsot.Objective(config)) == after
    other = fsot.Config(8, 16)
    with pytest.raises(ValueError, match=r"shape \[1, 16, 16, 1, 2\].*\[1, 16, 8, 1, 2\]"):
        metrics.bound(optimizer.table(), other)
    with pytest.raises(ValueError, match="leave out one"):
        metrics.bound(optimizer.points, config, kernel=fsot.Kernel.gaussian(2))


# Kinds of arrays


def variants(array):
    single = array.astype(numpy.float32)
    yield "a table", fsot.Table(single)
    yield "single", single
    yield "double", single.astype(numpy.float64)
    yield "big-endian", single.astype(">f4")
    yield "big-endian double", single.astype(">f8")
    yield "Fortran", numpy.asfortranarray(single)
    yield "negative strides", single[::-1, ::-1, ::-1, ::-1, ::-1].copy()[::-1, ::-1, ::-1, ::-1, ::-1]
    wide = numpy.zeros((*array.shape[:4], 7), numpy.float32)
    wide[..., 1:4] = single
    yield "a part of another", wide[..., 1:4]
    still = single.copy()
    still.flags.writeable = False
    yield "read-only", still
    yield "lists", single.tolist()
    yield "long double", single.astype(numpy.longdouble)


def test_every_kind_of_array_is_measured_alike(noise, integrands):
    def measured(samples):
        dims = [2, 0]
        return (
            metrics.filtered_error(samples, dims=dims, integrands=integrands),
            metrics.bias(samples, dims=dims, integrands=integrands),
            metrics.discrepancy(samples, dims=dims),
            metrics.bound(samples, slices=64),
            metrics.spectra(samples, dims=dims, integrands=integrands).xy.tobytes(),
            metrics.sliced_distance(samples, dims=dims),
            metrics.marginal(samples, 2).counts.tobytes(),
            metrics.histogram(samples, (0, 2)).counts.tobytes(),
            metrics.error_image(samples, linear(), dims=dims).errors.tobytes(),
        )

    expected = measured(noise)
    for name, samples in variants(noise):
        assert measured(samples) == expected, name


def test_halves_are_measured_as_what_they_are(noise):
    halves = (noise * 0.99).astype(numpy.float16)
    assert metrics.discrepancy(halves) == metrics.discrepancy(halves.astype(numpy.float64))


def test_double_precision_is_kept():
    # Rounded to single precision it would be 1.
    below_one = numpy.full((1, 1, 2, 1, 1), 1 - 1e-12)
    assert metrics.marginal(below_one, 0, 2).counts.tolist() == [0, 2]
    with pytest.raises(ValueError, match=r"give finite values in \[0, 1\)"):
        metrics.marginal(below_one.astype(numpy.float32), 0, 2)


def test_points_are_a_set(noise):
    points = noise.reshape(-1, 3)
    assert metrics.set_error(points, dims=[0, 1]) == metrics.set_error(noise, dims=[0, 1])
    assert metrics.bias(points, dims=[0, 1]).frame == metrics.bias(points, dims=[0, 1]).table


def test_results_do_not_depend_on_threads(noise, integrands):
    one, two = (
        metrics.filtered_error(noise, dims=[0, 1], integrands=integrands, threads=count) for count in (1, 2)
    )
    assert one == two


def test_a_forked_child_measures_too(noise):
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("nothing forks here")
    # The parent's threads are not the child's.
    expected = bias_and_picture(noise)
    with multiprocessing.get_context("fork").Pool(1) as pool, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert pool.apply_async(bias_and_picture, (noise,)).get(timeout=60) == expected


def bias_and_picture(noise):
    return metrics.bias(noise, dims=[0, 1]), fsot.Table(noise)._repr_png_()


WRONG = {
    "a number": (0.5, ValueError, "give a table"),
    "a line": (numpy.zeros(4), ValueError, "give a table"),
    "four axes": (numpy.zeros((2, 2, 2, 2)), ValueError, "give a table"),
    "no points": (numpy.zeros((0, 2)), ValueError, "number of points is 0"),
    "no pixels": (numpy.zeros((1, 0, 4, 1, 2)), ValueError, "number of points is 0"),
    "no dimensions": (numpy.zeros((3, 0)), ValueError, "number of dimensions is 0"),
    "one": (numpy.ones((2, 2)), ValueError, r"give finite values in \[0, 1\)"),
    "below zero": (numpy.full((2, 2), -1e-9), ValueError, r"give finite values in \[0, 1\)"),
    "NaN": (numpy.full((2, 2), numpy.nan), ValueError, "has NaN"),
    "infinite": (numpy.full((2, 2), numpy.inf), ValueError, r"give finite values in \[0, 1\)"),
    "whole numbers": (numpy.full((2, 2), 7), ValueError, r"give finite values in \[0, 1\)"),
    "complex": (numpy.zeros((2, 2), complex), TypeError, "complex128"),
    "texts": ([["a", "b"]], TypeError, "real numbers"),
    "objects": (numpy.zeros((2, 2), object), TypeError, "real numbers"),
    "nothing": (None, TypeError, "real numbers"),
    "ragged": ([[0.5], [0.5, 0.5]], TypeError, "numpy.asarray"),
    "dates": (numpy.zeros((2, 2), "M8[s]"), TypeError, "real numbers"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_measured_is_refused_by_every_metric(name):
    samples, error, words = WRONG[name]
    for measure in (
        metrics.filtered_error,
        metrics.bias,
        metrics.set_error,
        metrics.bound,
        metrics.spectra,
        metrics.discrepancy,
        metrics.sliced_distance,
        metrics.marginal,
        metrics.histogram,
        lambda samples: metrics.error_image(samples, linear()),
        lambda samples: metrics.density_match(samples, [[1.0]]),
    ):
        with pytest.raises(error, match=words):
            measure(samples)


def test_bad_questions_are_refused(noise):
    for dims, words in (
        ([0, 3], "3"),
        ([1, 1], "1"),
        ([], "dimension"),
        ([0, -1], "out of range"),
        ([0, 2**70], "out of range"),
    ):
        with pytest.raises(ValueError, match=words):
            metrics.filtered_error(noise, dims=dims)
    for dims in (["a"], 0.5, [0.5], "01"):
        with pytest.raises(TypeError):
            metrics.filtered_error(noise, dims=dims)
    with pytest.raises(ValueError, match="1 dimensions, but an integrand has 2"):
        metrics.bias(noise, dims=0, integrands=Integrands.random(2, 1))
    for bins in (0, 65537, -1):
        with pytest.raises(ValueError, match="bins|out of range"):
            metrics.marginal(noise, 0, bins)
    with pytest.raises(ValueError, match="cells per side"):
        metrics.histogram(noise, (0, 1), 0)
    with pytest.raises(ValueError, match="frames"):
        metrics.filtered_error(noise, dims=[0, 1], frames=4)
    with pytest.raises(ValueError, match="directions"):
        metrics.sliced_distance(noise, directions=0)
    for threads in (0, -1, 100_000, 2**70):
        with pytest.raises(ValueError, match="give a"):
            metrics.discrepancy(noise, threads=threads)
    with pytest.raises(ValueError, match="slices"):
        metrics.bound(noise, slices=0)
    with pytest.raises(ValueError, match=r"\[y, x\]"):
        metrics.density_match([[0.5, 0.5]], [1.0])
    with pytest.raises(ValueError, match="no density"):
        metrics.density_match([[0.5, 0.5]], fsot.Target.uniform())
    with pytest.raises(TypeError):
        metrics.bound(noise, "usual")
    for density in ([[0.0]], [[-1.0]], [[math.nan]], numpy.zeros((0, 3))):
        with pytest.raises(ValueError):
            metrics.density_match([[0.5, 0.5]], density)
    for image in ([1.0], [[math.nan]], numpy.zeros((0, 2)), [[0.0]]):
        with pytest.raises(ValueError):
            metrics.spectra_of_image(image)


# Integrands


def test_a_function_of_ones_own_is_measured_like_a_drawn_one(noise):
    drawn = Integrands.random(2, 3, 1)
    wrapped = Integrands(
        {
            family: [Integrand(one, 2, one.integral, one.variance) for one in members]
            for family, members in drawn.families.items()
        }
    )
    for measure in (metrics.filtered_error, metrics.bias, metrics.set_error):
        assert measure(noise, dims=[2, 0], integrands=wrapped) == measure(
            noise, dims=[2, 0], integrands=drawn
        )
    spectra = [metrics.spectra(noise, dims=[2, 0], integrands=which) for which in (wrapped, drawn)]
    assert spectra[0].xy.tobytes() == spectra[1].xy.tobytes()


def test_moments_are_estimated_well_enough():
    product = Integrand(lambda x: x.prod(axis=1), 3)
    assert product.integral == pytest.approx(1 / 8, abs=1e-4)
    assert product.variance == pytest.approx(1 / 27 - 1 / 64, abs=1e-4)


def test_a_function_is_called_once_with_all_points_that_it_cannot_change(noise):
    calls = []

    def function(x):
        calls.append((x.shape, x.dtype, x.flags.writeable, threading.get_ident()))
        return x[:, 0]

    integrand = Integrand(function, 2, 0.5, 1 / 12)
    metrics.filtered_error(noise, dims=[0, 1], integrands=Integrands({"mine": [integrand]}))
    assert calls == [((480, 2), numpy.float64, False, threading.get_ident())]


class Mine(Exception):
    pass


def test_what_a_function_raises_is_raised(noise):
    def fail(x):
        raise Mine("on purpose")

    for measure in (
        lambda: Integrand(fail, 2),
        lambda: metrics.error_image(noise, Integrand(fail, 2, 0.5, 1), dims=[0, 1]),
        lambda: metrics.bias(noise, dims=[0, 1], integrands=Integrands({"m": [Integrand(fail, 2, 0.5, 1)]})),
    ):
        with pytest.raises(Mine, match="on purpose"):
            measure()


def test_functions_may_measure_on_their_own(noise):
    def function(x):
        return x[:, 0] * metrics.discrepancy(noise).ratio

    integrands = Integrands({"mine": [Integrand(function, 2, 0.5, 1), linear()]})
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(metrics.bias(noise, dims=[0, 1], integrands=integrands)))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert len(found) == 4 and all(one == found[0] for one in found)


@pytest.mark.parametrize(
    "function, error, words",
    [
        (lambda x: x, ValueError, "one number for each"),
        (lambda x: x[:-1, 0], ValueError, "one number for each"),
        (lambda x: 1.0, ValueError, "one number for each"),
        (lambda x: x[:, 0] + numpy.nan, ValueError, "NaN at point 0"),
        (lambda x: x[:, 0] + 1j, TypeError, "complex"),
        (lambda x: None, TypeError, "real numbers"),
        (lambda x: ["a"] * len(x), TypeError, "real numbers"),
    ],
)
def test_functions_return_a_number_a_point(function, error, words, noise):
    with pytest.raises(error, match=words):
        metrics.error_image(noise, Integrand(function, 2, 0.5, 1), dims=[0, 1])


def test_moments_are_checked():
    with pytest.raises(TypeError, match="cannot be called"):
        Integrand(3, 2)
    for settings in (
        dict(dims=0),
        dict(dims=65),
        dict(dims=-1),
        dict(dims=2, points=0),
        dict(dims=2, points=1),
        dict(dims=64, points=2**26),
        dict(dims=2, integral=0.5),
        dict(dims=2, variance=0.5),
        dict(dims=2, integral=math.nan, variance=1),
        dict(dims=2, integral=0.5, variance=0),
        dict(dims=2, integral=0.5, variance=-1),
        dict(dims=2, integral=0.5, variance=math.inf),
    ):
        with pytest.raises(ValueError):
            Integrand(lambda x: x[:, 0], **settings)


def test_families_are_checked():
    with pytest.raises(ValueError, match="at least 1"):
        Integrands({})
    with pytest.raises(ValueError, match="at least 1"):
        Integrands({"mine": []})
    with pytest.raises(ValueError, match='two families are called "ball"'):
        Integrands.random(2, 1).with_family("ball", [linear()])
    with pytest.raises(ValueError, match='integrand 1 of "mine" has 3 coordinates instead of 2'):
        Integrands({"mine": [linear(), linear(3)]})
    with pytest.raises(TypeError):
        Integrands({"mine": [lambda x: x]})
    for wrong in (dict(dims=0), dict(dims=65), dict(per_family=0), dict(per_family=2**21), dict(seed=-1)):
        with pytest.raises(ValueError):
            Integrands.random(**wrong)


def test_integrands_are_named_by_their_seed_and_travel():
    few, many = Integrands.random(2, 4, 5), Integrands.random(2, 8, 5)
    points = numpy.random.default_rng(0).random((50, 2))
    for family, members in few.families.items():
        for one, same in zip(members, many.families[family]):
            assert one(points).tobytes() == same(points).tobytes()
            again = pickle.loads(pickle.dumps(one))
            assert again(points).tobytes() == one(points).tobytes()
            assert (again.integral, again.variance) == (one.integral, one.variance)
    again = pickle.loads(pickle.dumps(few))
    assert metrics.set_error(points, integrands=again) == metrics.set_error(points, integrands=few)
    mine = [Integrand(named, 2, 0.5, 1 / 12), few.families["box"][3]]
    for own in (Integrands({"mine": mine}), few.with_family("mine", mine)):
        again = pickle.loads(pickle.dumps(own))
        assert list(again.families) == list(own.families)
        assert metrics.set_error(points, integrands=again) == metrics.set_error(points, integrands=own)
    assert len(few) == 16 and few.dims == 2 and "4 ball" in repr(few)


def named(x):
    return x[:, 0]


# Rows


def test_results_make_a_row(noise, integrands):
    pandas = pytest.importorskip("pandas")

    def row(samples):
        return {
            **metrics.filtered_error(samples, dims=[0, 1], integrands=integrands).to_dict(),
            **metrics.bias(samples, dims=[0, 1], integrands=integrands).to_dict(),
            **metrics.bound(samples, slices=64).to_dict(),
            **metrics.spectra(samples, dims=[0, 1], integrands=integrands).to_dict(),
            **metrics.marginal(samples).to_dict(),
            **metrics.histogram(samples).to_dict(),
            **metrics.discrepancy(samples).to_dict(),
        }

    frame = pandas.DataFrame([row(noise), row(1 - noise.astype(numpy.float64))])
    assert frame.shape[0] == 2 and all(numpy.issubdtype(kind, numpy.number) for kind in frame.dtypes)
    found = metrics.filtered_error(noise, dims=[0, 1], integrands=integrands)
    assert frame["error_spatial"][0] == found.spatial.mean
    assert frame["error_spatial.ball_se"][0] == found.spatial.families["ball"].standard_error
    json.dumps(row(noise))


def test_no_figure_hides_another(noise):
    one = linear()
    integrands = Integrands({"a": [one], "a_se": [one]})
    with pytest.raises(ValueError, match="give families other names"):
        metrics.set_error(noise, dims=[0, 1], integrands=integrands).to_dict()


def test_results_travel_and_do_not_change(noise):
    found = metrics.bias(noise, dims=[0, 1])
    assert pickle.loads(pickle.dumps(found)) == found
    with pytest.raises(AttributeError):
        found.table = None
