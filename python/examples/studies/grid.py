"""Grids from a TOML file: which tables a study makes, and how they are measured."""

from __future__ import annotations

import dataclasses
import difflib
import hashlib
import itertools
import json
import math
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy

import fsot

from .task import sentence

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: What a grid may hold, with what is taken if it doesn't.
AXES: dict[str, list[Any]] = {
    "kernel": [2.1],
    "width": [64],
    "height": [64],
    "frames": [1],
    "spp": [1],
    "dims": [2],
    "domain": ["interval"],
    "seed": [0],
}
BUDGETS = ("sweeps", "slices", "seconds")
MEASURE: dict[str, Any] = {"under": "own", "integrands": 64, "slices": 4096, "seed": 0}
SECTIONS = ("grid", "kernels", "measure", "local", "slurm")
#: Shapes of kernels, with the library's names.
SHAPES = {"sigma": ("gaussian", "sigma_px"), "box": ("box", "size_px"), "binomial": ("binomial", "size_px")}


class StudyError(Exception):
    """What is wrong with a study, in a sentence."""


@dataclasses.dataclass(frozen=True)
class Task:
    """One table of a study."""

    #: SHA-256 of all that the row depends on.
    key: str
    #: Columns that say what the table is.
    labels: dict[str, Any]
    #: What `task.compute` is given: plain data.
    work: dict[str, Any]
    #: Why it cannot be made, if that is known before it is tried.
    refusal: str = ""


@dataclasses.dataclass(frozen=True)
class Study:
    """A file, read."""

    tasks: list[Task]
    #: Sections for clusters, as they stand in the file.
    local: dict[str, Any]
    slurm: dict[str, Any]


def read(path: Path) -> Study:
    """Reads a study from a TOML file.

    Raises
    ------
    StudyError
        If it cannot be read, or says what is not known.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise StudyError(f"{path}: {error}") from error
    _known(data, SECTIONS, "the file")
    for section, kind in (
        ("grid", list),
        ("kernels", dict),
        ("measure", dict),
        ("local", dict),
        ("slurm", dict),
    ):
        if not isinstance(data.get(section, kind()), kind):
            wanted = "[[grid]]" if kind is list else f"[{section}]"
            raise StudyError(f"{section} is no section: write {wanted}")
    for section in ("grid", "kernels", "measure"):
        _plain(data.get(section), section)
    if not data.get("grid"):
        raise StudyError(f"{path} makes no tables: write a [[grid]]")
    _known(data.get("local", {}), ["workers"], "[local]")
    for section, key in (("local", "workers"), ("slurm", "jobs")):
        _whole(key, data.get(section, {}).get(key, 1), 1)
    kernels = _Kernels(data.get("kernels", {}), path.parent)
    measure = MEASURE | data.get("measure", {})
    _known(measure, MEASURE, "[measure]")
    for key, least in (("integrands", 1), ("slices", 1), ("seed", 0)):
        _whole(key, measure[key], least)
    # Grids may overlap.
    tasks = {task.key: task for grid in data["grid"] for task in _tasks(grid, kernels, measure)}
    return Study(list(tasks.values()), data.get("local", {}), data.get("slurm", {}))


def _tasks(grid: dict[str, Any], kernels: _Kernels, measure: dict[str, Any]) -> Iterator[Task]:
    _known(grid, [*AXES, *BUDGETS, "seeds"], "[[grid]]")
    axes = {axis: _list(axis, grid.get(axis, usual)) for axis, usual in AXES.items()}
    if "seeds" in grid:
        if "seed" in grid:
            raise StudyError("seed and seeds say the same thing twice: leave out one of them")
        if type(grid["seeds"]) is not int or not 1 <= grid["seeds"] <= 1_000_000:
            raise StudyError(f"seeds is {grid['seeds']!r}: write how many, as in seeds = 5")
        axes["seed"] = list(range(grid["seeds"]))
    budgets = [(kind, amount) for kind in BUDGETS for amount in _list(kind, grid.get(kind, []))]
    # Seeds come last, so that the medians of few seeds are there early.
    order = sorted(AXES, key=lambda axis: axis != "seed")
    for values in itertools.product(*(axes[axis] for axis in order)):
        point = dict(zip(order, values))
        for budget in budgets or [("usual", None)]:
            yield _task(point, budget, kernels, measure)


def _task(point: dict[str, Any], budget: tuple[str, Any], kernels: _Kernels, measure: dict[str, Any]) -> Task:
    kind, amount = budget
    name, kernel = kernels.find(point["kernel"])
    labels = point | {"kernel": name, "budget": kind if amount is None else f"{kind}:{amount}"}
    work: dict[str, Any] = {"fsot": fsot.__version__, "measure": measure}
    try:
        numbers = {axis: point[axis] for axis in ("width", "height", "frames", "spp", "dims", "seed")}
        config = fsot.Config(**numbers).with_domain(point["domain"])
        until = fsot.Until.usual() if amount is None else getattr(fsot.Until, kind)(amount)
        work["config"] = config.with_kernel(_kernel(kernel, config)).to_dict()
        work["until"] = until.to_dict()
        if measure["under"] != "own":
            _, under = kernels.find(measure["under"])
            work["measure"] = measure | {"under": _kernel(under, config).to_dict()}
    except (ValueError, TypeError, OverflowError) as error:
        # The point stands for the configuration that it has not become.
        work |= {"point": point | {"kernel": kernel}, "until": budget}
        return Task(hashed(work), labels, work, sentence(error))
    return Task(hashed(work), labels, work)


class _Kernels:
    """Filters by name."""

    def __init__(self, named: dict[str, Any], folder: Path):
        self.folder = folder
        self.named = {name: self._checked(spec, f"kernels.{name}") for name, spec in named.items()}

    def find(self, spec: Any) -> tuple[str, dict[str, Any]]:
        """Name and table of what a grid says of a kernel: a name, a sigma, or a table."""
        if isinstance(spec, str):
            if spec not in self.named:
                raise StudyError(f"kernel '{spec}' is not among [kernels]{_like(spec, self.named)}")
            return spec, self.named[spec]
        if not isinstance(spec, dict):
            return f"sigma {spec}", self._checked(spec, f"kernel {spec}")
        name = " ".join(f"{key} {value}" for key, value in spec.items())
        return name, self._checked(spec, f"kernel {name}")

    def _checked(self, spec: Any, where: str) -> dict[str, Any]:
        if type(spec) in (int, float):
            return {"sigma": spec}
        if not isinstance(spec, dict):
            raise StudyError(f"{where} is {spec!r}: write a sigma, or a table such as {{ sigma = 2.1 }}")
        shapes = [*SHAPES, "taps"]
        _known(spec, [*shapes, "temporal"], where)
        given = [shape for shape in shapes if shape in spec]
        if len(given) != 1:
            raise StudyError(f"{where} has {len(given)} shapes: give one of {', '.join(shapes)}")
        return spec | {"taps": self._taps(spec["taps"], where)} if "taps" in spec else spec

    def _taps(self, name: Any, where: str) -> Any:
        if not isinstance(name, str):
            raise StudyError(f'{where}: taps are the name of a file, as in taps = "kernel.npy"')
        try:
            return numpy.load(self.folder / name, allow_pickle=False).tolist()
        except (OSError, ValueError, EOFError) as error:
            raise StudyError(f"{where}: {self.folder / name}: {sentence(error)}") from error


def _kernel(table: dict[str, Any], config: fsot.Config) -> fsot.Kernel:
    """The filter that a table says, for the frames of a configuration."""
    usual = config.kernels[0].to_dict()["temporal"]
    if "taps" in table:
        taps = numpy.asarray(table["taps"], dtype=numpy.float64)
        kernel = fsot.Kernel(taps)
        # Taps over frames say what is to happen in time.
        usual = usual if taps.ndim == 2 else "none"
    else:
        (own,) = table.keys() & SHAPES.keys()
        shape, size = SHAPES[own]
        kernel = fsot.Kernel.from_dict({"spatial": {shape: {size: table[own]}}})
    if "temporal" in table:
        return kernel.with_temporal(table["temporal"])
    return fsot.Kernel.from_dict(kernel.to_dict() | {"temporal": usual})


def hashed(data: Any) -> str:
    """SHA-256 of plain data, however its keys are ordered."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def _plain(value: Any, where: str) -> None:
    """Refuses what TOML knows and no table is made of: dates, and numbers that are none."""
    if isinstance(value, dict):
        for key, part in value.items():
            _plain(part, f"{where}.{key}")
    elif isinstance(value, list):
        for part in value:
            _plain(part, where)
    elif isinstance(value, float) and not math.isfinite(value):
        raise StudyError(f"{where} is {value}: give a finite number")
    elif not isinstance(value, (bool, int, float, str, type(None))):
        raise StudyError(f"{where} is a date or a time, {value}: write a number or a text in quotes")


def _list(axis: str, value: Any) -> list[Any]:
    values = value if isinstance(value, list) else [value]
    if not values and axis in AXES:
        raise StudyError(f"{axis} is an empty list: give a value, or leave it out")
    return values


def _whole(key: str, value: Any, least: int) -> None:
    if type(value) is not int or value < least:
        raise StudyError(f"{key} is {value!r}: give a whole number of at least {least}")


def _known(given: Iterable[str], known: Iterable[str], where: str) -> None:
    for key in given:
        if key not in known:
            raise StudyError(f"{where} has a key '{key}' that is not known{_like(key, known)}")


def _like(word: str, words: Iterable[str]) -> str:
    words = list(words)
    close = difflib.get_close_matches(word, words, 1)
    return f": did you mean '{close[0]}'?" if close else f": write one of {', '.join(words) or 'none'}"
