"""What metrics say."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple, TypeVar

import numpy
from numpy.typing import NDArray

_Figure = TypeVar("_Figure", float, "float | None")


class Estimate(NamedTuple):
    """A mean, and the uncertainty that the finite number of integrands leaves."""

    mean: float
    standard_error: float
    """It belongs to the choice of integrands: two tables that are measured with the *same* integrands differ
    by less noise than this. NaN for a single integrand."""


@dataclasses.dataclass(frozen=True)
class Ratios:
    """A ratio to white noise over test integrands: 1 is as good as independent random numbers, 0 is exact."""

    mean: float
    """Mean of the families, which count alike."""
    standard_error: float
    """Standard error of the mean."""
    families: Mapping[str, Estimate]
    """The families by their names."""

    def to_dict(self, name: str = "ratio") -> dict[str, float]:
        """``{name: mean, name_se: ..., name.family: ..., name.family_se: ...}``."""
        figures = [(name, self.mean), (f"{name}_se", self.standard_error)]
        for family, (mean, error) in self.families.items():
            figures += [(f"{name}.{family}", mean), (f"{name}.{family}_se", error)]
        return flat(figures)


@dataclasses.dataclass(frozen=True)
class FilteredError:
    """Mean squared error before and after filtering, each as a ratio to white noise of the same shape."""

    unfiltered: Ratios
    """Of single pixels."""
    spatial: Ratios
    """After the spatial part of the kernel alone."""
    spatio_temporal: Ratios
    """After the whole kernel; equal to `spatial` for a single frame."""

    def to_dict(self) -> dict[str, float]:
        """``error_unfiltered``, ``error_spatial``, ``error_spatio_temporal``: see `Ratios.to_dict`."""
        return _named(self, "error_{}", ["unfiltered", "spatial", "spatio_temporal"])


@dataclasses.dataclass(frozen=True)
class Bias:
    """Squared error of the mean over many samples, as a ratio to as many independent ones."""

    table: Ratios
    """All samples together."""
    frame: Ratios
    """The samples of a frame, averaged over frames."""
    pixel: Ratios
    """The samples of a pixel, averaged over pixels and frames."""

    def to_dict(self) -> dict[str, float]:
        """``bias_table``, ``bias_frame``, ``bias_pixel``: see `Ratios.to_dict`."""
        return _named(self, "bias_{}", ["table", "frame", "pixel"])


@dataclasses.dataclass(frozen=True)
class BoundEstimate:
    """An estimate of the objective with exact one-dimensional distances."""

    value: float
    """Mean 1-Wasserstein distance along a slice per sample that it touches, in units of the unit cube."""
    standard_error: float
    """Standard error of `value`."""
    ratio: float
    """The same over that of white noise of the same shape."""
    ratio_standard_error: float
    """Standard error of `ratio`."""


@dataclasses.dataclass(frozen=True)
class Bound(BoundEstimate):
    """The bound on the filtered error of samples: what is optimised."""

    terms: tuple[BoundEstimate, ...]
    """One estimate per term of the objective."""

    def to_dict(self) -> dict[str, float]:
        """``bound``, ``bound_se``, ``bound_ratio``, ``bound_ratio_se``."""
        return {
            "bound": self.value,
            "bound_se": self.standard_error,
            "bound_ratio": self.ratio,
            "bound_ratio_se": self.ratio_standard_error,
        }


@dataclasses.dataclass(frozen=True)
class AnisotropyRing:
    """How much more power a ring of frequencies has along y than along x."""

    start: float
    """Least radius, in cycles per pixel."""
    end: float
    """Greatest radius, exclusive."""
    along_y_over_along_x: float
    """1 where no direction is preferred; NaN where the tile has no such frequencies."""


@dataclasses.dataclass(frozen=True, eq=False)
class Radial:
    """Averages over rings of frequencies around zero, which is left out."""

    frequency: NDArray[numpy.float64]
    """Mean radius of a ring, in cycles per pixel; those beyond 0.5 lie in the corners only."""
    power: NDArray[numpy.float64]
    """Mean power; white noise is 1."""
    count: NDArray[numpy.float64]
    """Frequencies in the ring."""


@dataclasses.dataclass(frozen=True, eq=False)
class Spectra:
    """Power spectra of error images; white noise is 1 at every frequency. Zero frequency is in the middle."""

    xy: NDArray[numpy.float64]
    """Power over ``[ky, kx]`` (height × width), averaged over frames."""
    xt: NDArray[numpy.float64]
    """Power over ``[kt, kx]`` (frames × width), averaged over rows."""
    radial: Radial
    """Radial averages of `xy`."""
    anisotropy: tuple[AnisotropyRing, AnisotropyRing, AnisotropyRing]
    """Preferred directions of `xy`, in three rings from 0.15 to 0.5 cycles per pixel."""

    @property
    def fx(self) -> NDArray[numpy.float64]:
        """Frequencies along the last axis of both arrays, in cycles per pixel."""
        return _cycles(self.xy.shape[1])

    @property
    def fy(self) -> NDArray[numpy.float64]:
        """Frequencies along the first axis of `xy`, in cycles per pixel."""
        return _cycles(self.xy.shape[0])

    @property
    def ft(self) -> NDArray[numpy.float64]:
        """Frequencies along the first axis of `xt`, in cycles per frame."""
        return _cycles(self.xt.shape[0])

    def low_frequency_share(self, cutoff: float = 0.1) -> float:
        """Mean power of `xy` at radii above 0 up to `cutoff` cycles per pixel: 1 for white noise, near 0 for
        blue noise, NaN if no frequency is that low."""
        radius = numpy.hypot(self.fy[:, None], self.fx[None, :])
        low = self.xy[(radius > 0) & (radius <= cutoff)]
        return float(low.mean()) if low.size else math.nan

    def to_dict(self) -> dict[str, float]:
        """``power_low`` up to 0.1 cycles per pixel, and ``power_y_over_x_...`` of the three rings."""
        rings = {
            f"power_y_over_x_{ring.start:g}_{ring.end:g}": ring.along_y_over_along_x
            for ring in self.anisotropy
        }
        return {"power_low": self.low_frequency_share(), **rings}


@dataclasses.dataclass(frozen=True, eq=False)
class ErrorImage:
    """The error of every pixel, for one integrand."""

    errors: NDArray[numpy.float64]
    """``[frame, y, x]``: mean over the samples of the pixel, less the integral."""
    white_variance: float
    """Expected square of an error in white noise."""


@dataclasses.dataclass(frozen=True)
class FaceDensity:
    """How densely samples lie within a slab at either face of the cube."""

    within: float
    """Thickness of the slabs."""
    density: float
    """Samples in both slabs together, relative to the expectation of uniform ones."""
    standard_error: float
    """Standard error of the same of independent uniform samples."""


@dataclasses.dataclass(frozen=True, eq=False)
class Marginal:
    """How evenly one coordinate fills its interval, up to its ends."""

    counts: NDArray[numpy.uint64]
    """Samples per bin, from 0 to 1."""
    faces: tuple[FaceDensity, ...]
    """Density next to the faces, from the narrowest slab to the widest."""
    zeros: int
    """Samples that are exactly 0."""

    def to_dict(self) -> dict[str, float]:
        """Emptiest and fullest bin, and the two outermost, relative to the mean; densities at the faces."""
        share = self.counts / self.counts.mean()
        faces = {f"marginal_within_{face.within:g}": face.density for face in self.faces}
        return {
            "marginal_emptiest": float(share.min()),
            "marginal_fullest": float(share.max()),
            "marginal_ends": float((share[0] + share[-1]) / 2),
            **faces,
            "marginal_zeros": self.zeros,
        }


@dataclasses.dataclass(frozen=True, eq=False)
class Histogram:
    """How evenly samples fill the square of two dimensions."""

    counts: NDArray[numpy.uint64]
    """Samples per cell, ``[j, i]``: `i` along the first dimension, `j` along the second."""
    spread: float
    """Pearson's χ² / (cells - 1): 1 for random samples in the mean, 0 for equal counts, NaN for one cell."""

    def to_dict(self) -> dict[str, float]:
        """Spread; emptiest and fullest cell relative to the mean."""
        share = self.counts / self.counts.mean()
        return {
            "histogram_spread": self.spread,
            "histogram_emptiest": float(share.min()),
            "histogram_fullest": float(share.max()),
        }


@dataclasses.dataclass(frozen=True)
class Discrepancy:
    """Squared L2-star discrepancy of the samples of a frame, averaged over frames."""

    squared: float
    """In ``[0, 1]``."""
    ratio: float
    """The same over the expectation of as many independent random samples."""

    def to_dict(self) -> dict[str, float]:
        """``discrepancy_squared``, ``discrepancy_ratio``."""
        return {"discrepancy_squared": self.squared, "discrepancy_ratio": self.ratio}


@dataclasses.dataclass(frozen=True)
class BlockDeviation:
    """The block of pixels whose number of points is the least likely for its mass."""

    deviation: float
    """How far the number is off, in standard errors of independent points; negative where points miss."""
    column: int
    """Its first column."""
    row: int
    """Its first row."""
    side: int
    """Columns and rows; fewer at the picture's edges."""
    points: int
    """Points that it holds."""
    expected: float
    """Points that its mass calls for."""


@dataclasses.dataclass(frozen=True)
class DensityMatch:
    """How points follow a density."""

    correlation: float
    """Pearson's correlation of both pictures, blurred."""
    strays: int
    """Points that the blurred density does not reach."""
    worst: BlockDeviation
    """What no blur shows: the worst block of pixels."""

    def to_dict(self) -> dict[str, float]:
        """``correlation``, ``strays``, ``worst_deviation``."""
        worst = self.worst.deviation
        return {"correlation": self.correlation, "strays": self.strays, "worst_deviation": worst}


def flat(figures: Iterable[tuple[str, _Figure]]) -> dict[str, _Figure]:
    """A dictionary, of which no name stands for two figures."""
    known: dict[str, _Figure] = {}
    for name, figure in figures:
        if name in known:
            raise ValueError(f"two figures are called '{name}': give families other names")
        known[name] = figure
    return known


def _named(of: object, pattern: str, names: list[str]) -> dict[str, float]:
    parts = [getattr(of, name).to_dict(pattern.format(name)) for name in names]
    return flat(figure for part in parts for figure in part.items())


def _cycles(length: int) -> NDArray[numpy.float64]:
    return (numpy.arange(length) - length // 2) / length
