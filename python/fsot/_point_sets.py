"""Point sets in one call."""

from __future__ import annotations

import numbers
import os
import time
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _fsot
from ._optimizer import Optimizer
from ._points import Points

Picture: TypeAlias = ArrayLike | str | os.PathLike[str]
Callback: TypeAlias = Callable[[_fsot.Step], bool | None]

#: Names of the labels of `color_stippling`.
INKS = ("cyan", "magenta", "yellow", "black")


def classes(
    counts: int | Sequence[int],
    dims: int = 2,
    *,
    subsets: Literal["each_and_all", "every"] | Sequence[Sequence[int]] = "each_and_all",
    domain: str | list[str] | None = None,
    seed: int = 0,
    slices: int | None = None,
    seconds: float | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callback | None = None,
) -> Points:
    """Makes points in several classes: each class is uniform by itself, and so is their union.

    Parameters
    ----------
    counts : int or sequence of int
        Points of each class. They are labelled 0, 1, ..., and lie in this order.
    dims : int
        Coordinates of a point, 1 to 64.
    subsets : {"each_and_all", "every"} or sequence of sequences of int
        Which sets of classes are uniform: each class and all together; every set of them, for up to 12
        classes; or these lists of labels.
    domain : {"interval", "torus"} or list of these, optional
        As of `table`.
    seed : int
        Of all random numbers, 0 to 2**64 - 1. The same arguments make the same bits, on any number of
        threads, and the same as ``fsot points two-class``.
    slices : int, optional
        Directions that each set of classes is moved along; 4000 by default. 1000 make a good set.
    seconds : float, optional
        How long to work, instead of ``slices``. What is made then depends on the machine.
    threads : int, optional
        Threads to work on, 1 to 1024; one a core by default.
    progress : bool
        Whether to show a bar, on a terminal or in a notebook.
    callback : callable, optional
        Called with a `Step` after each step; ``False`` ends the run. An exception ends it, too, and is
        raised.

    Returns
    -------
    Points
        Coordinates ``[n, d]`` in ``[0, 1)`` and labels ``[n]``. Ctrl-C ends a run early and returns what it
        had reached, with the warning `Interrupted`.

    Raises
    ------
    ValueError
        No points, more than memory can number, labels that no class has.
    TypeError
        What is no number where one is needed.

    Examples
    --------
    >>> import fsot
    >>> fsot.classes([64, 32], subsets="every", slices=100, seed=7)
    <fsot.Points: 96 points of 2 dimensions, 2 labels>
    """
    each = [counts] if isinstance(counts, (int, numpy.integer)) else list(counts)
    plan = _fsot.plan_classes(each, dims, subsets, domain, seed)
    return _made(
        plan,
        "two-class",
        {"counts": each, "dims": dims, "subsets": _plain(subsets), "domain": domain, "seed": seed},
        [f"class {label}" for label in range(len(each))],
        slices, seconds, threads, progress, callback,
    )


def progressive(
    count: int = 4096,
    dims: int = 2,
    *,
    lengths: Literal["powers_of_two", "every"] | Sequence[int | tuple[int, float]] = "powers_of_two",
    domain: str | list[str] | None = None,
    seed: int = 0,
    slices: int | None = None,
    seconds: float | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callback | None = None,
) -> Points:
    """Makes a sequence of points whose beginnings are uniform.

    Parameters
    ----------
    count : int
        Points of the sequence.
    dims : int
        Coordinates of a point, 1 to 64. In two and more dimensions each coordinate alone is uniform as well,
        with a smaller weight.
    lengths : {"powers_of_two", "every"} or sequence of int or of pairs
        How long the beginnings are: 1, 2, 4, ... and all; 1, 2, 3, ...; or these numbers of points. A pair is
        a length and the weight of its pull, which is 1 over the length elsewhere.
    domain, seed, seconds, threads, progress, callback : optional
        As of `classes`; the same bits as ``fsot points progressive --seeds`` makes for each seed.
    slices : int, optional
        Directions that each beginning is moved along; 8000 by default.

    Returns
    -------
    Points
        Coordinates ``[n, d]`` in ``[0, 1)`` in the order of the sequence, without labels.

    Raises
    ------
    ValueError, TypeError
        As of `classes`.

    Examples
    --------
    >>> import fsot
    >>> sequence = fsot.progressive(64, slices=100)
    >>> sequence.array[:16].shape  # uniform, too
    (16, 2)
    """
    plan = _fsot.plan_progressive(count, dims, lengths, domain, seed)
    return _made(
        plan,
        "progressive",
        {"count": count, "dims": dims, "lengths": _plain(lengths), "domain": domain, "seed": seed},
        [],
        slices, seconds, threads, progress, callback,
    )


def stippling(
    picture: Picture,
    count: int = 8192,
    *,
    tone: Literal["dark", "bright"] = "dark",
    transfer: Literal["srgb", "linear"] | None = None,
    layer: str | None = None,
    most_pixels: int | None = 2**22,
    limit_pixels: int = 2**27,
    seed: int = 0,
    slices: int | None = None,
    seconds: float | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callback | None = None,
) -> Points:
    """Makes points as dense as a picture is dark, or bright.

    Parameters
    ----------
    picture : array_like or path
        Numbers ``[y, x]`` or ``[y, x, channel]``, rows from the top: of 1 channel (grey), 2 (grey and alpha),
        3 (red, green and blue) or 4 (the same and alpha). uint8 (255 is white) and uint16 (65535 is white)
        are taken for sRGB, as those of a PNG file; floats (1 is white) for linear light, as those of an EXR
        file; truth values for black and white. Colours are those before alpha multiplies them. Or the name of
        a PNG or EXR file. `matplotlib.pyplot.imread` gives floats that are sRGB: give ``transfer="srgb"``
        with them, or the name of the file.
    count : int
        Points.
    tone : {"dark", "bright"}
        Which part of the picture draws points: what its luminance (Rec. 709) lacks to white paper, or the
        light itself, as for importance sampling.
    transfer : {"srgb", "linear"}, optional
        What the numbers mean; by default as said above, or as a file says.
    layer : str, optional
        Which layer of an EXR file.
    most_pixels : int or None
        A picture of more pixels is averaged down to so many, mass for mass; None leaves every pixel as it is.
    limit_pixels : int
        A picture of more pixels is refused.
    seed, seconds, threads, progress, callback : optional
        As of `classes`; the same bits as ``fsot points stipple`` makes of a PNG file of the same numbers.
    slices : int, optional
        Directions that the points are moved along; 16000 by default.

    Returns
    -------
    Points
        Coordinates ``[n, 2]`` in ``[0, 1)``, x from the left edge of the picture to the right one, y from the
        top to the bottom, whatever its sides; `Points.aspect` is their ratio.

    Raises
    ------
    OSError
        A file that cannot be read.
    ValueError
        A file that is no picture; an array of another shape, with NaN, with light that is negative or
        infinite where light draws points, or with nothing that draws any (all white, or all black where
        ``tone`` is ``"bright"``).
    TypeError
        An array of other numbers.

    Examples
    --------
    Three quarters of the points go to the right:

    >>> import fsot, numpy
    >>> dark = numpy.array([[0.75, 0.25]])  # light, so that 0.25 and 0.75 are missing to white
    >>> points = fsot.stippling(dark, 64, slices=500)
    >>> bool(46 <= (points.array[:, 0] > 0.5).sum() <= 50)
    True
    """
    plan = _fsot.plan_stippling(
        picture, count, tone, transfer, layer, most_pixels, limit_pixels, seed, threads
    )
    reading = {"transfer": transfer, "layer": layer, "most_pixels": most_pixels, "limit_pixels": limit_pixels}
    return _made(
        plan,
        "stipple",
        {"picture": _name(picture), "count": count, "tone": tone, **reading, "seed": seed},
        ["ink"],
        slices, seconds, threads, progress, callback,
    )


def color_stippling(
    picture: Picture,
    count: int = 24576,
    *,
    transfer: Literal["srgb", "linear"] | None = None,
    layer: str | None = None,
    most_pixels: int | None = 2**22,
    limit_pixels: int = 2**27,
    seed: int = 0,
    slices: int | None = None,
    seconds: float | None = None,
    threads: int | None = None,
    progress: bool = True,
    callback: Callback | None = None,
) -> Points:
    """Makes points in cyan, magenta, yellow and black that resemble a picture on white paper.

    Black replaces what the colours have in common, and every set of inks is spread like its part of the
    picture, so that dots of different inks avoid each other as well.

    Parameters
    ----------
    picture, transfer, layer, most_pixels, limit_pixels :
        As of `stippling`.
    count : int
        Points in all.
    seed, seconds, threads, progress, callback : optional
        As of `classes`; the same bits as ``fsot points color-stipple`` makes of a PNG file of the same
        numbers.
    slices : int, optional
        Directions that each set of inks is moved along; 1000 by default.

    Returns
    -------
    Points
        Coordinates ``[n, 2]`` as of `stippling`, and labels: 0 for cyan, 1 for magenta, 2 for yellow, 3 for
        black, in this order, as many of each as its share of the ink.

    Raises
    ------
    OSError, ValueError, TypeError
        As of `stippling`.

    Examples
    --------
    >>> import fsot, numpy
    >>> cyan_and_black = numpy.array([[[0, 255, 255], [0, 0, 0]]], numpy.uint8)
    >>> dots = fsot.color_stippling(cyan_and_black, 100, slices=100)
    >>> [len(dots.of(ink)) for ink in range(4)]
    [50, 0, 0, 50]
    """
    plan = _fsot.plan_color_stippling(
        picture, count, transfer, layer, most_pixels, limit_pixels, seed, threads
    )
    reading = {"transfer": transfer, "layer": layer, "most_pixels": most_pixels, "limit_pixels": limit_pixels}
    return _made(
        plan,
        "color-stipple",
        {"picture": _name(picture), "count": count, **reading, "seed": seed},
        list(INKS),
        slices, seconds, threads, progress, callback,
    )


def _made(
    plan: tuple[_fsot.Config, NDArray[numpy.uint32] | None, int, float],
    kind: str,
    arguments: dict[str, Any],
    labels: list[str],
    slices: int | None,
    seconds: float | None,
    threads: int | None,
    progress: bool,
    callback: Callback | None,
) -> Points:
    config, label_of, usual_slices, aspect = plan
    if slices is None and seconds is None:
        slices = usual_slices
    until = _fsot.until(seconds, None, slices)
    began = time.perf_counter()
    optimizer = Optimizer(config, threads=threads)
    planned = time.perf_counter() - began
    optimizer._follow(until, callback, progress, depth=2)
    metadata = {
        "kind": kind,
        "arguments": _whole(arguments | {"slices": slices, "seconds": seconds}),
        "labels": labels,
        "aspect": aspect,
        "run": {"planning_seconds": planned, **optimizer._record()},
    }
    array = optimizer.points
    # They are nobody else's.
    for own in (array, label_of):
        if own is not None:
            own.flags.writeable = False
    return Points(array.reshape(-1, array.shape[-1]), label_of, metadata)


def _plain(named: str | Sequence[Any]) -> Any:
    """What may be a sequence of sequences, as lists."""
    if isinstance(named, str):
        return named
    return [one if isinstance(one, numbers.Number) else list(one) for one in named]


def _name(picture: Picture) -> str:
    if isinstance(picture, (str, os.PathLike)):
        return os.fspath(picture)
    array = numpy.asarray(picture)
    return f"array of {array.dtype} {list(array.shape)}"


def _whole(data: Any) -> Any:
    """Python's numbers instead of numpy's."""
    if isinstance(data, dict):
        return {key: _whole(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_whole(value) for value in data]
    return data.item() if isinstance(data, numpy.generic) else data
