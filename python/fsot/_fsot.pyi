from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy
from numpy.typing import ArrayLike, NDArray

# metrics

@final
class Integrand:
    def __new__(
        cls,
        function: Callable[[NDArray[numpy.float64]], ArrayLike],
        dims: int,
        integral: float | None = None,
        variance: float | None = None,
        *,
        points: int = 262144,
    ) -> Integrand: ...
    @property
    def dims(self) -> int: ...
    @property
    def integral(self) -> float: ...
    @property
    def variance(self) -> float: ...
    def __call__(self, points: ArrayLike) -> NDArray[numpy.float64]: ...

@final
class Integrands:
    def __new__(cls, families: dict[str, list[Integrand]]) -> Integrands: ...
    @staticmethod
    def random(dims: int = 2, per_family: int = 256, seed: int = 0) -> Integrands: ...
    def with_family(self, name: str, integrands: Sequence[Integrand]) -> Integrands: ...
    @property
    def dims(self) -> int: ...
    @property
    def families(self) -> dict[str, list[Integrand]]: ...
    def __len__(self) -> int: ...

_Dims: TypeAlias = int | Sequence[int] | None
_OfFamilies: TypeAlias = tuple[tuple[float, float], list[tuple[str, tuple[float, float]]]]
_BoundFigures: TypeAlias = tuple[float, float, float, float]
_SpectraArrays: TypeAlias = tuple[
    NDArray[numpy.float64],
    NDArray[numpy.float64],
    list[NDArray[numpy.float64]],
    list[tuple[float, float, float]],
]

def measure_filtered_error(
    samples: ArrayLike,
    dims: _Dims,
    integrands: Integrands | None,
    kernel: Kernel | None,
    frames: int | None,
    threads: int | None,
) -> list[_OfFamilies]: ...
def measure_bias(
    samples: ArrayLike, dims: _Dims, integrands: Integrands | None, threads: int | None
) -> list[_OfFamilies]: ...
def measure_set_error(
    samples: ArrayLike, dims: _Dims, integrands: Integrands | None, threads: int | None
) -> _OfFamilies: ...
def measure_bound(
    samples: ArrayLike,
    config: Config | None,
    kernel: Kernel | None,
    slices: int,
    seed: int,
    threads: int | None,
) -> tuple[_BoundFigures, list[_BoundFigures]]: ...
def measure_spectra(
    samples: ArrayLike, dims: _Dims, integrands: Integrands | None, threads: int | None
) -> _SpectraArrays: ...
def spectra_of_image(errors: ArrayLike, variance: float | None) -> _SpectraArrays: ...
def measure_error_image(
    samples: ArrayLike, integrand: Integrand, dims: _Dims, threads: int | None
) -> tuple[NDArray[numpy.float64], float]: ...
def measure_marginal(
    samples: ArrayLike, dim: int, bins: int, threads: int | None
) -> tuple[NDArray[numpy.uint64], list[tuple[float, float, float]], int]: ...
def measure_histogram(
    samples: ArrayLike, dims: Sequence[int], cells_per_side: int, threads: int | None
) -> tuple[NDArray[numpy.uint64], float]: ...
def measure_discrepancy(samples: ArrayLike, dims: _Dims, threads: int | None) -> tuple[float, float]: ...
def measure_sliced_distance(
    samples: ArrayLike, dims: _Dims, target: Any, directions: int, threads: int | None
) -> float: ...
def measure_density_match(
    samples: ArrayLike, density: ArrayLike, sigma: float, dims: Sequence[int], threads: int | None
) -> tuple[tuple[float, int], tuple[float, int, int, int, int, float]]: ...
