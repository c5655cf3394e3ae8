"""Tables in one call."""

from __future__ import annotations

from collections.abc import Callable

from . import _fsot
from ._optimizer import Optimizer
from ._table import Table


def table(
    width: int = 64,
    height: int = 64,
    frames: int = 1,
    spp: int = 1,
    dims: int = 2,
    *,
    sigma: float | None = None,
    temporal=None,
    kernel=None,
    groups=None,
    domain=None,
    demand: _fsot.Demand | None = None,
    seed: int = 0,
    seconds: float | None = None,
    sweeps: int | None = None,
    slices: int | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callable[[_fsot.Step], bool | None] | None = None,
) -> Table:
    """Makes a sample table."""
    config = _fsot.configure(
        width, height, frames, spp, dims,
        sigma=sigma, temporal=temporal, kernel=kernel, groups=groups, domain=domain, seed=seed,
    )
    until = _fsot.until(seconds, sweeps, slices)
    optimizer = Optimizer(config, demand=demand, threads=threads)
    optimizer._follow(until, callback, progress)
    return optimizer.table()
