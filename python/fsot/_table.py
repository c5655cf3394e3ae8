"""Sample tables."""

from __future__ import annotations

import copy
import hashlib
import operator
import os
import pathlib
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _fsot, _glance
from ._arrays import numbers, read_only, refuse_masked
from ._figures import flat_figures

if TYPE_CHECKING:
    from ._exchange import Exported

_FORMATS = {
    ".png": "atlas",
    ".ktx2": "ktx2",
    ".exr": "exr",
    ".raw": "raw",
    ".bin": "fast",
    ".cpp": "pbrt",
    ".h": "c",
    ".csv": "csv",
    ".dat": "dat",
}


class Table:
    """A sample table: what renderers read.

    Parameters
    ----------
    array : array_like
        Numbers in ``[0, 1)`` of shape ``[frame, y, x, sample, dim]``; float32 in C order is not copied.
    metadata : dict, optional
        Where it comes from, and notes under names of your own: plain data, which `save` keeps.
    """

    def __init__(self, array: ArrayLike, metadata: Mapping[str, Any] | None = None):
        self._array: NDArray[numpy.float32] = read_only(numbers(array, "numbers"), numpy.float32)
        _fsot.check_table(self._array)
        self._metadata = dict(metadata or {})

    @property
    def array(self) -> NDArray[numpy.float32]:
        """Numbers in ``[0, 1)``, ``[frame, y, x, sample, dim]``: a view that cannot be written to."""
        return self._array

    @property
    def metadata(self) -> dict[str, Any]:
        """Where it comes from: configuration, seed, run; empty if that is not known. Notes may be added."""
        return self._metadata

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """Lengths of the axes ``[frame, y, x, sample, dim]``."""
        return self._array.shape

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes ``path``, which ends in ``.npy``, and the metadata in a ``.json`` beside it.

        Raises
        ------
        OSError
            What cannot be written. Both files are as they were then.
        ValueError
            Metadata of other values than these, or with parts that would be lost.
        """
        _fsot.save_table(path, self._array, self._metadata or None)
        beside = pathlib.Path(path).with_suffix(".json")
        if not self._metadata and beside.exists():
            warnings.warn(
                f"{beside} is not of this table: delete it, or load the table with metadata=False",
                stacklevel=2,
            )

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, metadata: bool = True) -> Table:
        """Reads a table that was saved, with the metadata beside it if there are any.

        Metadata that are damaged or of another table are refused; without them, ``metadata=False``, the table
        is read all the same. Other files: `fsot.import_table`.
        """
        return cls(*_fsot.load_table(path, metadata))

    def sample(
        self, frame: ArrayLike = 0, y: ArrayLike = 0, x: ArrayLike = 0, sample: ArrayLike = 0
    ) -> NDArray[numpy.float32]:
        """The coordinates of samples, as a renderer reads them: all four indices wrap.

        Parameters
        ----------
        frame, y, x, sample : int or array_like of int
            Whole numbers, which are broadcast against each other.

        Returns
        -------
        ndarray
            Float32, of the indices' shape and ``[dim]``.

        Examples
        --------
        >>> import fsot
        >>> table = fsot.table(16, 16, sweeps=10, progress=False)
        >>> table.sample(y=3, x=16 + 5).tolist() == table.array[0, 3, 5, 0].tolist()
        True
        """
        wrapped = [_wrapped(at, length) for at, length in zip((frame, y, x, sample), self.shape)]
        found: NDArray[numpy.float32] = self._array[tuple(wrapped)]
        return found

    def displacement(self, use: int) -> tuple[int, int]:
        """Rows and columns by which the `use`-th use of the table in a frame is displaced as a whole.

        Nearby samples of a table are correlated. Steps of the R2 sequence keep the first 36 uses of 64 × 64
        pixels at least 8 pixels from each other, and 128 uses of 128 × 128. Use 0 stays in place.
        """
        return _fsot.displacement(self.shape[1], self.shape[2], use)

    def tile(
        self, width: int, height: int, *, frame: int = 0, use: int = 0
    ) -> NDArray[numpy.float32]:
        """The samples of a picture of any size, which the table tiles.

        Parameters
        ----------
        width, height : int
            Pixels of the picture.
        frame : int
            The frame; those beyond the last begin anew.
        use : int
            How often pixels have read the table before, in this frame: for further dimensions or samples than
            it has. See `displacement`.

        Returns
        -------
        ndarray
            ``[y, x, sample, dim]``, float32.
        """
        for name, length in (("width", width), ("height", height)):
            if operator.index(length) < 1:
                raise ValueError(f"{name} is {length}: give a whole number from 1 on")
        dy, dx = self.displacement(use)
        rows = (numpy.arange(height) + dy) % self.shape[1]
        columns = (numpy.arange(width) + dx) % self.shape[2]
        plane: NDArray[numpy.float32] = self._array[operator.index(frame) % self.shape[0]]
        return plane[rows[:, None], columns]

    def mapped(self, mapping: str, dims: tuple[int, int] = (0, 1)) -> NDArray[numpy.float32]:
        """Two dimensions as vectors, by a map that keeps uniform what is uniform.

        Parameters
        ----------
        mapping : {"disc", "sphere", "cosine-hemisphere"}
            The unit disc by the concentric map; the unit sphere; the hemisphere ``z >= 0`` of density
            ``z / pi``.
        dims : pair of int
            The dimensions.

        Returns
        -------
        ndarray
            ``[frame, y, x, sample, component]``, float32, of 2 components for the disc, else 3.
        """
        return _fsot.mapped_table(self._array, mapping, dims)

    def inspect(
        self,
        *,
        kernel: _fsot.Kernel | None = None,
        integrands: int = 256,
        slices: int = 16384,
        seed: int = 0,
        name: str = "table",
        nested: bool = False,
        threads: int | None = None,
    ) -> dict[str, Any]:
        """The figures of ``fsot inspect``, most of them ratios to white noise: 1 is random, 0 no error.

        Parameters
        ----------
        kernel : Kernel, optional
            The filter: ``exp(-r² / 2.1²)`` by default and, where there are frames, the eye's at 60 Hz.
        integrands : int
            Test integrands per family.
        slices : int
            Slices per term of the bound, fewer for large subsets.
        seed : int
            Names the integrands, and the slices of the bound.
        name : str
            What the table is called among the figures.
        nested : bool
            Return what ``fsot inspect --json`` prints.
        threads : int, optional
            Threads to work on; one a core by default.

        Returns
        -------
        dict
            A row of a study, ``pandas.DataFrame([table.inspect()])``: shape, and for the first two dimensions
            the names that `fsot.metrics` gives, such as ``error_spatial``, ``bias_table``, ``bound_ratio``;
            ``_se`` are standard errors. Names of other groups of dimensions begin like ``dims_2_3.``. What is not
            defined for such a table is None, so that figures can be notes: ``table.metadata["figures"]``.
        """
        found = _fsot.inspect_table(
            name, self._array, self._metadata or None, kernel, integrands, slices, seed, threads
        )
        return found if nested else flat_figures(found)

    def report(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        png: str | os.PathLike[str] | None = None,
        label: str = "table",
        others: Mapping[str, Table] | None = None,
        kernel: _fsot.Kernel | None = None,
        integrands: int | None = None,
        slices: int = 4096,
        seed: int = 0,
        threads: int | None = None,
    ) -> None:
        """Writes the page of ``fsot report``: samples, errors, spectra and figures beside white noise.

        Parameters
        ----------
        path : path, optional
            The page, one HTML file that needs no network.
        png : path, optional
            The pictures alone, without words.
        label : str
            What the table is called on the page.
        others : dict, optional
            Further tables by their labels, side by side.
        kernel : Kernel, optional
            The filter, as of `inspect`.
        integrands : int, optional
            Test integrands per family: 256 by default, fewer for large tables, so that it takes some seconds.
        slices : int
            Slices per term of the bound.
        seed : int
            Names integrands, slices and white noise.
        threads : int, optional
            Threads to work on; one a core by default.
        """
        if path is None and png is None:
            raise ValueError("there is nothing to write: give a path, or png=")
        if path is not None and png is not None and os.path.realpath(path) == os.path.realpath(png):
            raise ValueError(f"{path} is named twice: give png= another name")
        tables = {label: self, **(others or {})}
        if others and label in others:
            raise ValueError(f"two tables are called '{label}': give the others other names, or label=")
        shown = [(str(name), table.array, table.metadata or None) for name, table in tables.items()]
        _fsot.report_tables(path, png, shown, kernel, integrands, slices, seed, threads)

    def export(
        self,
        path: str | os.PathLike[str],
        format: str | None = None,
        *,
        bits: int | str | None = None,
        rounding: str = "floor",
        name: str | None = None,
    ) -> Exported:
        """Writes the table as textures, or in another format that engines read, as ``fsot export`` does.

        Parameters
        ----------
        path : path
            Where to write; if several files are made, their names begin like this one. They appear all or
            none, with a record beside them: ``path`` and ``.json``.
        format : str, optional
            ``atlas`` or ``slices`` of PNG, ``ktx2``, ``exr``, ``exr-layers``, ``raw``, ``fast``, ``pbrt``,
            ``c``, ``csv``, ``dat``. By default what the ending of the path says, an ``atlas`` for ``.png``.
        bits : {8, 16, "half", 32}, optional
            The numbers in the files; what is usual in the format by default. A level `k` of 8 bits stands for
            ``(k + 1/2) / 256``.
        rounding : {"floor", "diffuse"}
            How values become levels.
        name : str, optional
            Names of the files, without folder and ending, with ``{name}``, ``{kind}``, ``{width}``,
            ``{height}``, ``{frames}``, ``{frame}``, ``{sample}`` and ``{dims}`` where these shall stand.

        Returns
        -------
        Exported
            The files, and how to read them. `fsot.import_table` does.
        """
        from ._exchange import Exported

        if format is None:
            ending = pathlib.PurePath(path).suffix.lower()
            if ending not in _FORMATS:
                known = ", ".join(_FORMATS)
                raise ValueError(f"the ending of {path} names no format: give format=, or one of {known}")
            format = _FORMATS[ending]
        depth = None if bits is None else str(bits)
        files, record_path, record = _fsot.export_table(path, self._array, format, depth, rounding, name)
        return Exported(tuple(files), record_path, record)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return numpy.array(self._array, dtype=dtype, copy=copy)

    def __reduce__(self) -> tuple[Any, ...]:
        # By what makes it: an array that is read alone can be written to.
        return type(self), (self._array, copy.deepcopy(self._metadata))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and numpy.array_equal(self._array, other._array)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<fsot.Table: {self._words()}>"

    def _repr_html_(self) -> str:
        return _glance.page(self._array, self._metadata, self._words())

    def _repr_png_(self) -> bytes:
        return _fsot.glance_at_table(self._array)[0]

    def _words(self) -> str:
        frames, height, width, spp, dims = self.shape
        return (
            f"{_count(frames, 'frame')}, {width} x {height} pixels, "
            f"{_count(spp, 'sample')} of {_count(dims, 'dimension')}"
        )


def made(array: NDArray[numpy.float32], metadata: dict[str, Any]) -> Table:
    """A table, whose metadata say of which values they are: nobody else's may be saved with them."""
    # It is nobody else's.
    array.flags.writeable = False
    table = Table(array, metadata)
    little_endian = table.array.astype("<f4", copy=False)
    table.metadata["sha256"] = hashlib.sha256(little_endian.data).hexdigest()
    return table


def _wrapped(number: ArrayLike, length: int) -> int | NDArray[numpy.integer[Any]]:
    if isinstance(number, int) and not isinstance(number, bool):
        # Also what no array holds.
        return number % length
    refuse_masked(number, "indices")
    array = numpy.asarray(number)
    if array.dtype.kind not in "iu":
        raise TypeError(f"an index of dtype {array.dtype}: give whole numbers from -2**63 to 2**64 - 1")
    return array % length


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
