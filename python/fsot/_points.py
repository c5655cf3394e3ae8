"""Point sets."""

from __future__ import annotations

import copy
import numbers as kinds
import operator
import os
from typing import Any

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _fsot
from ._arrays import numbers, read_only
from ._table import _count


class Points:
    """Points of the unit cube, some with labels.

    Parameters
    ----------
    array : array_like
        Coordinates in ``[0, 1)`` of shape ``[n, d]``; float32 in C order is not copied. In the plane the
        first one runs to the right; the second runs down where points follow a picture.
    labels : array_like, optional
        A whole number per point, from 0 to 2**32 - 1: its class, or its ink.
    metadata : dict, optional
        Where they come from.

    See Also
    --------
    classes, progressive, stippling, color_stippling : functions that make some.

    Examples
    --------
    >>> import fsot
    >>> points = fsot.classes([32, 16], slices=100)
    >>> points
    <fsot.Points: 48 points of 2 dimensions, 2 labels>
    >>> points.of(1).shape
    (16, 2)
    """

    def __init__(
        self,
        array: ArrayLike,
        labels: ArrayLike | None = None,
        metadata: dict[str, Any] | None = None,
    ):
        self._array: NDArray[numpy.float32] = _coordinates(array)
        self._labels: NDArray[numpy.uint32] | None = None
        if labels is not None:
            self._labels = _labels(labels, len(self._array))
        self._metadata = dict(metadata or {})

    @property
    def array(self) -> NDArray[numpy.float32]:
        """Coordinates in ``[0, 1)``, ``[n, d]``: a view that cannot be written to."""
        return self._array

    @property
    def labels(self) -> NDArray[numpy.uint32] | None:
        """The label of each point, ``[n]``, or None: a view that cannot be written to."""
        return self._labels

    @property
    def metadata(self) -> dict[str, Any]:
        """Where they come from: ``kind``, ``arguments``, names of ``labels``, ``run``; empty if not known."""
        return self._metadata

    @property
    def aspect(self) -> float:
        """How many times as wide as high the picture is that the unit square stands for; 1 without one.

        To draw points: ``axes.scatter(points.array[:, 0] * points.aspect, points.array[:, 1])`` with equal
        axes, and ``axes.invert_yaxis()`` if they follow a picture.
        """
        aspect = self._metadata.get("aspect", 1.0)
        if not isinstance(aspect, kinds.Real) or not 1e-4 <= float(aspect) <= 1e4:
            raise ValueError(f"metadata['aspect'] is {aspect!r}: give width over height, from 1e-4 to 1e4")
        return float(aspect)

    def of(self, *labels: int) -> NDArray[numpy.float32]:
        """The points with one of these labels, ``[m, d]``, a copy; points without labels have the label 0."""
        own = numpy.zeros(len(self), numpy.uint32) if self._labels is None else self._labels
        points: NDArray[numpy.float32] = self._array[numpy.isin(own, [operator.index(one) for one in labels])]
        return points

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the coordinates, and how they were made beside them, as the command does.

        Parameters
        ----------
        path : path
            A name that ends in ``.npy``, for a float32 array ``[n, d + 1]`` whose last column is the label
            (0 for points without labels), or in ``.csv``, for the same with a header. Metadata go to the same
            name with the ending ``.points.json``. Each file appears whole or not at all.

        Raises
        ------
        OSError
            What the system refuses.
        ValueError
            Another ending.
        """
        _fsot.save_points(path, self._array, self._labels, self._metadata)

    def __len__(self) -> int:
        return len(self._array)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return numpy.array(self._array, dtype=dtype, copy=copy)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Points):
            return NotImplemented
        if not numpy.array_equal(self._array, other._array):
            return False
        if self._labels is None or other._labels is None:
            return self._labels is other._labels
        return numpy.array_equal(self._labels, other._labels)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return Points, (self._array, self._labels, copy.deepcopy(self._metadata))

    def __repr__(self) -> str:
        count, dims = self._array.shape
        text = f"<fsot.Points: {_count(count, 'point')} of {_count(dims, 'dimension')}"
        if self._labels is not None:
            text += f", {_count(len(numpy.unique(self._labels)), 'label')}"
        return text + ">"

    def _repr_png_(self) -> bytes:
        """A drawing, for notebooks: each class and all together, prefixes of a sequence, or a sheet."""
        kind = str(self._metadata.get("kind", ""))
        return _fsot.draw_points(self._array, self._labels, kind, self.aspect)


def _coordinates(given: ArrayLike) -> NDArray[numpy.float32]:
    array = numbers(given, "coordinates")
    if array.ndim != 2 or array.shape[1] == 0:
        raise ValueError(f"points of shape {array.shape}: give two axes [n, d]")
    array = read_only(array, numpy.float32)
    outside = ~((array >= 0) & (array < 1))
    if outside.any():
        point, dim = (int(at) for at in numpy.argwhere(outside)[0])
        raise ValueError(
            f"coordinate {dim} of point {point} is {array[point, dim]}: give numbers from 0 to below 1"
        )
    return array


def _labels(given: ArrayLike, count: int) -> NDArray[numpy.uint32]:
    array = numbers(given, "labels")
    if array.shape != (count,):
        raise ValueError(f"labels of shape {array.shape}: give one for each of the {count} points")
    if array.dtype.kind not in "bui" and not numpy.array_equal(array, numpy.floor(array)):
        raise ValueError("labels that are no whole numbers: give numbers from 0 to 2**32 - 1")
    if count and not (array.min() >= 0 and array.max() < 2**32):
        raise ValueError(f"labels from {array.min()} to {array.max()}: give numbers from 0 to 2**32 - 1")
    return read_only(array, numpy.uint32)
