"""Arrays as they are given."""

from __future__ import annotations

from typing import Any

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray


def numbers(given: ArrayLike, what: str) -> NDArray[Any]:
    """Real numbers, not copied where that can be had."""
    refuse_masked(given, what)
    try:
        array = numpy.asarray(given)
    except (TypeError, ValueError) as error:
        raise TypeError(f"no array of {what}: {error}; give one that numpy.asarray takes") from None
    if array.dtype.kind not in "buif":
        raise TypeError(f"{what} of dtype {array.dtype}: give real numbers")
    return array


def refuse_masked(given: Any, what: str) -> None:
    """`numpy.asarray` would give what is below the mask."""
    parts = [given] if hasattr(given, "mask") else given if isinstance(given, (list, tuple)) else []
    if any(hasattr(part, "mask") and numpy.ma.is_masked(part) for part in parts):
        raise TypeError(f"{what} that are masked in part: fill them, as by array.filled(0)")


def read_only(array: NDArray[Any], dtype: DTypeLike) -> NDArray[Any]:
    """A view in C order that cannot be written to, nor made so where a conversion has copied."""
    converted = numpy.asarray(array, dtype=dtype, order="C")
    if converted is not array:
        converted.flags.writeable = False
    view = converted.view()
    view.flags.writeable = False
    return view
