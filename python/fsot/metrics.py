"""What a table is worth: filtered error, bias, uniformity and spectra.

Every figure that can be one is a *ratio to white noise*: 1 means as good as independent random numbers in a
table of the same shape, 0 means no error. The denominator is the analytic expectation, never a draw.

Samples are a `fsot.Table`, an array ``[frame, y, x, sample, dim]`` or points ``[point, dim]``, float32 or
float64, of values in ``[0, 1)``. ``dims`` are the dimensions that are used together, in the order of the
integrand's coordinates; all, if they are left out. Results are small objects that do not change;
``to_dict()`` gives their figures under names of their own, so that a row of a study is

>>> import fsot
>>> table = fsot.table(16, 16, sweeps=10, progress=False)
>>> error, bias = fsot.metrics.filtered_error(table), fsot.metrics.bias(table)
>>> row = {**error.to_dict(), **bias.to_dict(), **fsot.metrics.bound(table).to_dict()}
>>> error.spatial.mean == row["error_spatial"]
True

==========================================================================  ============================
how large is the error that the eye sees?                                   `filtered_error`
what is the objective worth, with exact distances?                          `bound`
does the table, a frame, a pixel estimate integrals too high or too low?    `bias`
are the samples spread evenly over the square?                              `histogram`, `discrepancy`
... and every single coordinate, up to its faces?                           `marginal`
what is the error of a prefix, of a class, of a point set?                  `set_error`
do points follow a picture?                                                 `density_match`
how far is a point set from its target?                                     `sliced_distance`
at which frequencies is the error, and does it prefer a direction?          `spectra`
what is the error of each pixel, for one integrand?                         `error_image`
==========================================================================  ============================

Work runs without the interpreter's lock, on ``threads`` threads (one a core by default); results do not
depend on their number. Ctrl-C raises `KeyboardInterrupt` at once, here as in `Table.inspect`, `Table.report`
and `Kernel.taps`. Such work cannot be stopped: it is left alone, uses its threads and memory until it ends by
itself or the process exits, and leaves nothing behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from numpy.typing import ArrayLike

from . import _fsot
from ._fsot import Config, Integrand, Integrands, Kernel, Objective, Target
from ._results import (
    AnisotropyRing,
    Bias,
    BlockDeviation,
    Bound,
    BoundEstimate,
    DensityMatch,
    Discrepancy,
    ErrorImage,
    Estimate,
    FaceDensity,
    FilteredError,
    Histogram,
    Marginal,
    Radial,
    Ratios,
    Spectra,
)

__all__ = [
    "AnisotropyRing",
    "Bias",
    "BlockDeviation",
    "Bound",
    "BoundEstimate",
    "DensityMatch",
    "Discrepancy",
    "ErrorImage",
    "Estimate",
    "FaceDensity",
    "FilteredError",
    "Histogram",
    "Integrand",
    "Integrands",
    "Marginal",
    "Radial",
    "Ratios",
    "Spectra",
    "bias",
    "bound",
    "density_match",
    "discrepancy",
    "error_image",
    "filtered_error",
    "histogram",
    "marginal",
    "set_error",
    "sliced_distance",
    "spectra",
    "spectra_of_image",
]

Samples: TypeAlias = ArrayLike
"""A `fsot.Table`, an array ``[frame, y, x, sample, dim]`` or points ``[point, dim]``."""
Dims: TypeAlias = "int | Sequence[int] | None"
"""Dimensions that are used together; all if `None`."""


def filtered_error(
    samples: Samples,
    *,
    dims: Dims = None,
    integrands: Integrands | None = None,
    kernel: Kernel | None = None,
    frames: int | None = None,
    threads: int | None = None,
) -> FilteredError:
    """Mean squared error before and after filtering, as ratios to white noise of the same shape.

    Parameters
    ----------
    samples : Table or array_like
        ``[frame, y, x, sample, dim]``; points count as a row of pixels.
    dims : sequence of int, optional
        Dimensions that are used together.
    integrands : Integrands, optional
        256 random ones per family by default, as in ``fsot inspect``.
    kernel : Kernel, optional
        The filter: ``exp(-r² / 2.1²)`` by default and, where there are frames, the eye's at 60 Hz.
    frames : int, optional
        Average over so many frames at equal distances instead of all of them.
    threads : int, optional
        Threads to work on.

    Returns
    -------
    FilteredError
        ``.spatial.mean`` and the like.
    """
    found = _fsot.measure_filtered_error(samples, dims, integrands, kernel, frames, threads)
    return FilteredError(*map(_ratios, found))


def bias(
    samples: Samples,
    *,
    dims: Dims = None,
    integrands: Integrands | None = None,
    threads: int | None = None,
) -> Bias:
    """Squared error of the mean over all samples, a frame, a pixel, as ratios to as many independent samples.

    Filters reach a few pixels only: what is biased is so in the whole picture. Parameters as of
    `filtered_error`.
    """
    return Bias(*map(_ratios, _fsot.measure_bias(samples, dims, integrands, threads)))


def set_error(
    samples: Samples,
    *,
    dims: Dims = None,
    integrands: Integrands | None = None,
    threads: int | None = None,
) -> Ratios:
    """Squared error of the mean over all samples, as a ratio to as many independent random points.

    Parameters as of `filtered_error`; the samples of a table count as one set.
    """
    return _ratios(_fsot.measure_set_error(samples, dims, integrands, threads))


def bound(
    samples: Samples,
    objective: Config | Objective | None = None,
    *,
    kernel: Kernel | None = None,
    slices: int = 16384,
    seed: int = 0,
    threads: int | None = None,
) -> Bound:
    """The objective, with exact one-dimensional distances, on random slices.

    Parameters
    ----------
    samples : Table or array_like
        Of the shape that the configuration has.
    objective : Config or Objective, optional
        Whose bound it is; by default that of the usual objective for samples of this shape and `kernel`, as
        in ``fsot inspect``.
    kernel : Kernel, optional
        The filter of the usual objective: see `filtered_error`.
    slices : int
        About so many per term, fewer for terms with large subsets. 16384 leave half a percent.
    seed : int
        Names the slices, which are not those of a run.
    threads : int, optional
        Threads to work on.
    """
    total, terms = _fsot.measure_bound(samples, objective, kernel, slices, seed, threads)
    return Bound(*total, terms=tuple(BoundEstimate(*term) for term in terms))


def spectra(
    samples: Samples,
    *,
    dims: Dims = None,
    integrands: Integrands | None = None,
    threads: int | None = None,
) -> Spectra:
    """Power spectra of the error in x and y, and in x and t, averaged over integrands.

    Each is relative to its own white noise. Parameters as of `filtered_error`.
    """
    return _spectra(_fsot.measure_spectra(samples, dims, integrands, threads))


def spectra_of_image(errors: ArrayLike, variance: float | None = None) -> Spectra:
    """Spectra of an error image ``[y, x]`` or ``[frame, y, x]``, of a renderer, say.

    Parameters
    ----------
    errors : array_like
        Finite numbers.
    variance : float, optional
        That of a pixel in white noise; the image's own mean square by default, which looks at the shape
        alone.
    """
    return _spectra(_fsot.spectra_of_image(errors, variance))


def error_image(
    samples: Samples,
    integrand: Integrand,
    *,
    dims: Dims = None,
    threads: int | None = None,
) -> ErrorImage:
    """The error of every pixel: mean over its samples, less the integral."""
    return ErrorImage(*_fsot.measure_error_image(samples, integrand, dims, threads))


def marginal(samples: Samples, dim: int = 0, bins: int = 64, *, threads: int | None = None) -> Marginal:
    """Counts the samples of one dimension in 1 to 65536 equal bins, and next to the faces of the cube."""
    counts, faces, zeros = _fsot.measure_marginal(samples, dim, bins, threads)
    return Marginal(counts, tuple(FaceDensity(*face) for face in faces), zeros)


def histogram(
    samples: Samples,
    dims: tuple[int, int] = (0, 1),
    cells_per_side: int = 16,
    *,
    threads: int | None = None,
) -> Histogram:
    """Counts the samples of two dimensions in equal cells, 1 to 4096 a side.

    Expect at least 5 samples a cell.
    """
    counts, spread = _fsot.measure_histogram(samples, dims, cells_per_side, threads)
    return Histogram(counts.reshape(cells_per_side, cells_per_side), spread)


def discrepancy(samples: Samples, *, dims: Dims = None, threads: int | None = None) -> Discrepancy:
    """Squared L2-star discrepancy of a frame, by Warnock's formula.

    The work grows by the square of the samples of a frame: 64 × 64 take some 10 ms, 256 × 256 some 5 s of a
    core.
    """
    return Discrepancy(*_fsot.measure_discrepancy(samples, dims, threads))


def sliced_distance(
    samples: Samples,
    *,
    dims: Dims = None,
    target: Target | ArrayLike | None = None,
    directions: int = 256,
    threads: int | None = None,
) -> float:
    """Sliced 2-Wasserstein distance of points to a target.

    Parameters
    ----------
    samples : Table or array_like
        All count as one set.
    dims : sequence of int, optional
        Dimensions that are used together.
    target : Target or array_like, optional
        What the points should follow, or a density ``[y, x]``; the uniform cube by default.
    directions : int
        Directions over which squares are averaged.
    threads : int, optional
        Threads to work on.

    Returns
    -------
    float
        Root of the mean over directions of the squared distance, in units of the cube, or of the picture's
        longer side.
    """
    return _fsot.measure_sliced_distance(samples, dims, target, directions, threads)


def density_match(
    samples: Samples,
    density: Target | ArrayLike,
    sigma: float = 0.02,
    *,
    dims: tuple[int, int] = (0, 1),
    threads: int | None = None,
) -> DensityMatch:
    """How points follow a picture: after both are blurred, and by their numbers in blocks of pixels.

    Parameters
    ----------
    samples : Table or array_like
        Points: x to the right, y down.
    density : Target or array_like
        ``Target.density``, or numbers ``[y, x]`` that are not negative.
    sigma : float
        Standard deviation of the blur, in units of the picture's longer side, in ``(0, 1]``: about two
        distances between neighbouring points is what an eye blurs.
    dims : pair of int
        Dimensions that run to the right and down.
    threads : int, optional
        Threads to work on.
    """
    (correlation, strays), worst = _fsot.measure_density_match(samples, density, sigma, dims, threads)
    return DensityMatch(correlation, strays, BlockDeviation(*worst))


def _ratios(found: tuple[tuple[float, float], list[tuple[str, tuple[float, float]]]]) -> Ratios:
    (mean, error), families = found
    return Ratios(mean, error, {name: Estimate(*estimate) for name, estimate in families})


def _spectra(found: tuple[Any, ...]) -> Spectra:
    xy, xt, radial, anisotropy = found
    first, second, third = (AnisotropyRing(*ring) for ring in anisotropy)
    return Spectra(xy, xt, Radial(*radial), (first, second, third))
