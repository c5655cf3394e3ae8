"""Tables in one call."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike

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
    temporal: str | ArrayLike | None = None,
    kernel: ArrayLike | _fsot.Kernel | None = None,
    groups: Sequence[Sequence[int] | tuple[Sequence[int], float]] | None = None,
    domain: str | list[str] | None = None,
    demand: _fsot.Demand | None = None,
    seed: int = 0,
    seconds: float | None = None,
    sweeps: int | None = None,
    slices: int | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callable[[_fsot.Step], bool | None] | None = None,
) -> Table:
    """Makes a sample table.

    Parameters
    ----------
    width, height : int
        Pixels of the tile, which repeats. 64 is good for most uses; `dims`, `frames` and `spp` cost memory,
        too: a table holds at most 2**31 - 1 numbers.
    frames : int
        Frames of the animation, which repeats.
    spp : int
        Samples per pixel and frame.
    dims : int
        Numbers of a sample, 1 to 64.
    sigma : float, optional
        Of the Gaussian ``exp(-r**2 / sigma**2)`` that the picture will be seen through, in pixels, above 0
        and at most 1e6; 2.1 by default. Its standard deviation is ``sigma / sqrt(2)``.
    temporal : str or array_like, optional
        The filter over frames: ``"ema:0.1"`` (temporal antialiasing that keeps 90 % of the history),
        ``"perceptual:60"`` (the eye, at 60 frames per second), ``"gaussian:SIGMA"``, ``"box:N"``,
        ``"binomial:N"``, ``"none"``, or the weights of the current frame, the one before, and so on. The eye
        at 60 frames per second by default where there are several frames.
    kernel : array_like or Kernel, optional
        The filter over pixels, instead of ``sigma``: weights ``[y, x]``, multiplied by ``temporal`` over
        frames, or weights ``[t, y, x]``, the current frame first, which stand for ``temporal`` as well; see
        `Kernel` for where they are centred. Not more of them than a frame has pixels, each way. A `Kernel` is
        taken as it is, over frames too, unless it says nothing of those and ``temporal`` does.
    groups : sequence, optional
        Which dimensions the renderer uses together: lists of dimensions such as ``[[0, 1], [2]]``, or pairs
        of a list and its weight. Consecutive pairs by default, and all of them at half the weight.
    domain : {"interval", "torus"} or list of these, optional
        ``"torus"`` where numbers will be shifted modulo 1, in all dimensions or in each. Intervals by
        default.
    demand : Demand, optional
        The part of the table that the renderer reads in earnest; all by default.
    seed : int
        Of all random numbers, 0 to 2**64 - 1. The same arguments make the same bits, on any number of
        threads.
    seconds, sweeps, slices : optional
        How long to work: `Until.seconds`, `Until.sweeps`, `Until.slices`, or ``sweeps`` after ``slices``. By
        default as much as is usually worth it, some ten seconds of a core for large tables and less for small
        ones. What is made in a number of ``seconds`` depends on the machine; its metadata make it again.
    threads : int, optional
        Threads to work on, 1 to 1024; one a core by default.
    progress : bool
        Whether to show a bar, on a terminal or in a notebook.
    callback : callable, optional
        Called with a `Step` after each step; ``False`` ends the run. An exception ends it, too, and is
        raised.

    Returns
    -------
    Table
        Numbers in ``[0, 1)``, `Table.array` of shape ``[frame, y, x, sample, dim]``, and where they come
        from. Ctrl-C ends a run early and returns what it had reached, with the warning `Interrupted`.

    Raises
    ------
    ValueError
        For a number out of its range. Its sentence says which, and what to do.
    TypeError
        For what is no number where one is needed.

    See Also
    --------
    Config, Optimizer : the same, one thing at a time.

    Examples
    --------
    A still picture with 4 samples of 2 numbers per pixel:

    >>> import fsot
    >>> table = fsot.table(32, 32, spp=4, sweeps=20, seed=7)
    >>> table
    <fsot.Table: 1 frame, 32 x 32 pixels, 4 samples of 2 dimensions>

    An animation under temporal antialiasing:

    >>> fsot.table(16, 16, frames=8, temporal="ema:0.1", sweeps=5)
    <fsot.Table: 8 frames, 16 x 16 pixels, 1 sample of 2 dimensions>
    """
    config = _fsot.configure(
        width, height, frames, spp, dims,
        sigma=sigma, temporal=temporal, kernel=kernel, groups=groups, domain=domain, seed=seed,
    )
    until = _fsot.until(seconds, sweeps, slices)
    optimizer = Optimizer(config, demand=demand, threads=threads)
    optimizer._follow(until, callback, progress)
    return optimizer.table()
