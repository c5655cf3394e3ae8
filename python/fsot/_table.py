"""Sample tables."""

from __future__ import annotations

import os
from typing import Any

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _fsot


class Table:
    """A sample table: what renderers read.

    Parameters
    ----------
    array : array_like
        Numbers in ``[0, 1)`` of shape ``[frame, y, x, sample, dim]``; float32 in C order is not copied.
    metadata : dict, optional
        Where it comes from.
    """

    def __init__(self, array: ArrayLike, metadata: dict[str, Any] | None = None):
        array = numpy.asarray(array, dtype=numpy.float32, order="C").view()
        _fsot.check_table(array)
        array.flags.writeable = False
        self._array: NDArray[numpy.float32] = array
        self._metadata = dict(metadata or {})

    @property
    def array(self) -> NDArray[numpy.float32]:
        """Numbers in ``[0, 1)``, ``[frame, y, x, sample, dim]``: a view that cannot be written to."""
        return self._array

    @property
    def metadata(self) -> dict[str, Any]:
        """Where it comes from: configuration, seed, run; empty if that is not known."""
        return self._metadata

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """Lengths of the axes ``[frame, y, x, sample, dim]``."""
        return self._array.shape

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes ``path``, which ends in ``.npy``, and the metadata in a ``.json`` beside it."""
        _fsot.save_table(path, self._array, self._metadata or None)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Table:
        """Reads a table that was saved, with the metadata beside it if there are any."""
        return cls(*_fsot.load_table(path))

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return numpy.array(self._array, dtype=dtype, copy=copy)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and numpy.array_equal(self._array, other._array)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        frames, height, width, spp, dims = self.shape
        return (
            f"<fsot.Table: {_count(frames, 'frame')}, {width} x {height} pixels, "
            f"{_count(spp, 'sample')} of {_count(dims, 'dimension')}>"
        )


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
