"""Types of the compiled half of the package; its documentation is in the sources of that half."""

import os
import pathlib
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, TypeAlias, final

import numpy
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self, disjoint_base

__all__ = [
    "Checkpoint",
    "Config",
    "Integrand",
    "Integrands",
    "Kernel",
    "Optimizer",
    "Report",
    "Step",
    "Until",
    "__version__",
    "check_table",
    "command",
    "configure",
    "displacement",
    "export_table",
    "glance_at_table",
    "import_table",
    "inspect_table",
    "load_table",
    "mapped_table",
    "measure_bias",
    "measure_bound",
    "measure_density_match",
    "measure_discrepancy",
    "measure_error_image",
    "measure_filtered_error",
    "measure_histogram",
    "measure_marginal",
    "measure_set_error",
    "measure_sliced_distance",
    "measure_spectra",
    "report_tables",
    "save_table",
    "spectra_of_image",
    "until",
]

__version__: str

_Domain: TypeAlias = str | list[str]
_Group: TypeAlias = Sequence[int] | tuple[Sequence[int], float]
_Path: TypeAlias = str | os.PathLike[str]
_Temporal: TypeAlias = str | ArrayLike
_Taken: TypeAlias = tuple[
    str, str, list[int], list[str], int | None, int, int, list[int], pathlib.Path | None
]

@final
class Until:
    __hash__: ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def usual() -> Until: ...
    @staticmethod
    def seconds(seconds: float) -> Until: ...
    @staticmethod
    def sweeps(sweeps: int) -> Until: ...
    @staticmethod
    def slices(slices: int) -> Until: ...
    @staticmethod
    def work(*, frame_sweeps: int = 0, slices: int = 0, sweeps: int = 0) -> Until: ...
    @staticmethod
    def converged(
        improvement: float = 0.01, *, window_steps: int = 64, at_most: int = 10_000
    ) -> Until: ...
    def to_dict(self) -> Any: ...
    @staticmethod
    def from_dict(data: Any) -> Until: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Kernel:
    __hash__: ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def gaussian(sigma: float = 2.1, *, temporal: _Temporal | None = None) -> Kernel: ...
    @staticmethod
    def box_(size: int, *, temporal: _Temporal | None = None) -> Kernel: ...
    @staticmethod
    def binomial(size: int, *, temporal: _Temporal | None = None) -> Kernel: ...
    def with_temporal(self, temporal: _Temporal) -> Kernel: ...
    def taps(self, width: int = 64, height: int = 64, frames: int = 1) -> NDArray[numpy.float64]: ...
    def to_dict(self) -> dict[str, Any]: ...
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Kernel: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Config:
    __hash__: ClassVar[None]  # type: ignore[assignment]
    def __new__(
        cls,
        width: int = 64,
        height: int = 64,
        frames: int = 1,
        spp: int = 1,
        dims: int = 2,
        *,
        seed: int = 0,
    ) -> Self: ...
    @property
    def shape(self) -> tuple[int, int, int, int, int]: ...
    @property
    def seed(self) -> int: ...
    @property
    def kernels(self) -> list[Kernel]: ...
    def with_seed(self, seed: int) -> Config: ...
    def with_kernel(self, kernel: Kernel) -> Config: ...
    def with_kernels(self, kernels: Sequence[Kernel]) -> Config: ...
    def with_groups(self, groups: Sequence[_Group]) -> Config: ...
    def with_domain(self, domain: _Domain) -> Config: ...
    def with_companions(self, companions: bool) -> Config: ...
    def to_dict(self) -> dict[str, Any]: ...
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Config: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> Config: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Report:
    @property
    def ended(self) -> str: ...
    @property
    def steps(self) -> int: ...
    @property
    def slices(self) -> int: ...
    @property
    def work(self) -> Until: ...
    @property
    def elapsed(self) -> float: ...

@final
class Step:
    @property
    def step(self) -> int: ...
    @property
    def steps(self) -> int: ...
    @property
    def slices(self) -> int: ...
    @property
    def displacement(self) -> float: ...
    @property
    def rate(self) -> float: ...
    @property
    def elapsed(self) -> float: ...
    @property
    def points(self) -> NDArray[numpy.float32]: ...
    @property
    def loss(self) -> float: ...
    def checkpoint(self) -> Checkpoint: ...

@final
class Checkpoint:
    @staticmethod
    def load(path: _Path) -> Checkpoint: ...
    def save(self, path: _Path) -> None: ...
    @property
    def config(self) -> Config: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> Checkpoint: ...

@disjoint_base
class Optimizer:
    def __new__(cls, config: Config, *, threads: int | None = None) -> Self: ...
    @property
    def config(self) -> Config: ...
    @property
    def points(self) -> NDArray[numpy.float32]: ...
    @points.setter
    def points(self, points: ArrayLike) -> None: ...
    def step(self, rate: float = 1.0, balance: float = 1.0) -> float: ...
    def sweep(self, rate: float = 1.0, balance: float = 1.0) -> float: ...
    def checkpoint(self) -> Checkpoint: ...
    def resume(self, checkpoint: Checkpoint) -> None: ...
    def _run(
        self,
        until: Until | None,
        callback: Callable[[Step], bool | None] | None,
        progress: Callable[[Step], None] | None,
    ) -> tuple[Report, BaseException | None]: ...
    def _table(self) -> tuple[NDArray[numpy.float32], dict[str, Any]]: ...

def configure(
    width: int,
    height: int,
    frames: int,
    spp: int,
    dims: int,
    *,
    sigma: float | None,
    temporal: _Temporal | None,
    kernel: Kernel | None,
    groups: Sequence[_Group] | None,
    domain: _Domain | None,
    seed: int,
) -> Config: ...
def until(seconds: float | None, sweeps: int | None, slices: int | None) -> Until: ...
def save_table(path: _Path, array: ArrayLike, metadata: dict[str, Any] | None) -> None: ...
def displacement(height: int, width: int, use_number: int) -> tuple[int, int]: ...
def mapped_table(array: ArrayLike, mapping: str, dims: Sequence[int]) -> NDArray[numpy.float32]: ...
def glance_at_table(array: NDArray[numpy.float32]) -> tuple[bytes, list[tuple[str, bytes]]]: ...
def inspect_table(
    name: str,
    array: ArrayLike,
    metadata: dict[str, Any] | None,
    kernel: Kernel | None,
    integrands: int,
    slices: int,
    seed: int,
    threads: int | None,
) -> dict[str, Any]: ...
def report_tables(
    html: _Path | None,
    png: _Path | None,
    tables: Sequence[tuple[str, ArrayLike, dict[str, Any] | None]],
    kernel: Kernel | None,
    integrands: int | None,
    slices: int,
    seed: int,
    threads: int | None,
) -> None: ...
def export_table(
    path: _Path, array: ArrayLike, format: str, bits: str | None, rounding: str, name: str | None
) -> tuple[list[pathlib.Path], pathlib.Path, dict[str, Any]]: ...
def import_table(
    path: _Path,
    axes: Sequence[str],
    levels: int | None,
    lengths: Sequence[int | None],
    channels: int | None,
    dtype: str | None,
    array: str | None,
) -> tuple[NDArray[numpy.float32], _Taken]: ...
def load_table(
    path: _Path, metadata: bool
) -> tuple[NDArray[numpy.float32], dict[str, Any] | None]: ...
def check_table(array: ArrayLike) -> None: ...
def command(arguments: Sequence[str]) -> int: ...

# metrics

@final
class Integrand:
    @staticmethod
    def _drawn(dims: int, seed: int, family: int, index: int) -> Integrand: ...
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
    def _drawn(
        dims: int, per_family: int, seed: int, others: dict[str, list[Integrand]]
    ) -> Integrands: ...
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
    aim: Config | Objective | None,
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
    samples: ArrayLike, dims: _Dims, target: Target | ArrayLike | None, directions: int, threads: int | None
) -> float: ...
def measure_density_match(
    samples: ArrayLike, density: Target | ArrayLike, sigma: float, dims: Sequence[int], threads: int | None
) -> tuple[tuple[float, int], tuple[float, int, int, int, int, float]]: ...
