"""Tables in other people's formats."""

from __future__ import annotations

import dataclasses
import os
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy
from numpy.typing import DTypeLike

from . import _fsot
from ._table import Table

_AXES = ("frame", "y", "x", "sample", "dim")


@dataclasses.dataclass(frozen=True)
class Imported:
    """A table of somebody else's file, and what was taken for what. ``str(imported)`` is one sentence."""

    table: Table
    """The table."""
    dtype: str
    """Type of the values as the file writes it; ``text`` for text."""
    shape: tuple[int, ...]
    """Shape of the file."""
    axes: tuple[str, ...]
    """Its axes; empty where it is a list of samples in the order of a table."""
    levels: int | None
    """Levels of whole numbers; `None` for fractions."""
    first_level: int
    """The lowest level: 1 for ranks that are counted from 1."""
    ones: int
    """Values of 1 that became the largest number below."""
    left_out: tuple[int, ...]
    """Channels of a texture that were left out, because they are constant or like another."""
    record: pathlib.Path | None
    """The record of the export that said how to read the file."""
    sentence: str = dataclasses.field(repr=False)
    """All of it in words."""

    def __str__(self) -> str:
        return self.sentence


def import_table(
    path: str | os.PathLike[str],
    *,
    axes: str | Sequence[str] | None = None,
    levels: int | None = None,
    frames: int | None = None,
    height: int | None = None,
    width: int | None = None,
    spp: int | None = None,
    dims: int | None = None,
    channels: int | None = None,
    dtype: DTypeLike | None = None,
    array: str | None = None,
) -> Imported:
    """Makes a table of somebody else's file, as ``fsot import`` does.

    Parameters
    ----------
    path : path
        A ``.npy`` array of any plain type, byte and memory order; a PNG, KTX 2 or EXR texture; text with
        numbers; an array in C or C++; bare numbers; a set of files, as ``"mask_{frame}.png"``; what
        `Table.export` has written, which is read by its record unless the other arguments say otherwise.
    axes : str or sequence of str, optional
        The axes of the file, slowest first: some of ``frame``, ``y``, ``x``, ``sample``, ``dim``. Excludes
        lengths. Found by their number and lengths, if they are left out.
    levels : int, optional
        Of how many levels whole numbers are: `v` becomes ``(v + 1/2) / levels``.
    frames, height, width, spp, dims : int, optional
        Lengths of a list of samples in the order ``[frame, y, x, sample, dim]``. One may be missing, or width
        and height of a square picture.
    channels : int, optional
        Numbers that a sample takes in a list, of which the first `dims` are read.
    dtype : dtype, optional
        The type of the numbers of a file without a header, such as ``"<f4"``.
    array : str, optional
        Which array of a C or C++ source text.

    Returns
    -------
    Imported
        ``.table``, and what was taken for what.

    Raises
    ------
    OSError
        A file that cannot be read.
    ValueError
        One that is damaged, or cannot be a table with these arguments.
    """
    lengths = [frames, height, width, spp, dims]
    names = [] if axes is None else axes.split(",") if isinstance(axes, str) else list(axes)
    if names and any(length is not None for length in [*lengths, channels]):
        raise ValueError("axes and lengths say the same thing twice: leave out one of them")
    for name, length in zip(
        ["levels", "frames", "height", "width", "spp", "dims", "channels"], [levels, *lengths, channels]
    ):
        if length == 0:
            raise ValueError(f"{name} is 0: give a whole number from 1 on")
    text = None if dtype is None else numpy.dtype(dtype).str
    found, taken = _fsot.import_table(path, names, levels, lengths, channels, text, array)
    sentence, text, shape, axes, levels, first, ones, left_out, record = taken
    return Imported(
        Table(found), text, tuple(shape), tuple(axes), levels, first, ones, tuple(left_out), record, sentence
    )


@dataclasses.dataclass(frozen=True)
class Exported:
    """What was written."""

    files: tuple[pathlib.Path, ...]
    """The files, without the record."""
    record_path: pathlib.Path
    """The record beside them, by which `import_table` reads them again."""
    record: dict[str, Any]
    """What it says: among others ``decode``, what a number of the files stands for, and which part of the
    table each file holds."""
