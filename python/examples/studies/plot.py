"""Error against time, a curve per kernel."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .grid import StudyError, Task
from .task import Row

#: What panels differ in.
PANEL = ("width", "height", "frames", "spp", "dims", "domain")
#: Colours that stay apart in grey and for the colour-blind (Okabe and Ito), and markers.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
MARKERS = "osD^vPX"


def draw(tasks: Iterable[Task], rows: dict[str, Row], path: Path) -> int:
    """Draws what is done of the tasks, and returns how many tables that were.

    A point is a budget: the median over seeds of the error, over that of the seconds. Bars reach from the
    least to the largest of the seeds. Shapes have panels of their own.
    """
    try:
        import matplotlib
    except ImportError as error:
        raise StudyError("pictures need matplotlib: pip install matplotlib") from error
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullLocator

    shapes = panels(tasks, rows)
    if not shapes:
        raise StudyError("nothing is done that could be drawn: run the study first")
    columns = min(len(shapes), 4 if len(shapes) > 4 else 2)
    lines = -(-len(shapes) // columns)
    # In the order of the grid.
    kernels = list(dict.fromkeys(kernel for curves in shapes.values() for kernel in curves))
    told = [
        at for at, of in enumerate(PANEL) if of in ("spp", "dims") or len({shape[at] for shape in shapes}) > 1
    ]
    with matplotlib.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(0.6 + 3.2 * columns, 0.9 + 2.5 * lines), layout="constrained", dpi=160)
        grid = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        for axes, (shape, curves) in zip(grid.flat, sorted(shapes.items())):
            for number, kernel in enumerate(kernels):
                if kernel in curves:
                    _curve(axes, points(curves[kernel]), number, kernel)
            axes.set(xscale="log", yscale="log")
            axes.yaxis.set(major_locator=LogLocator(subs=(1, 2, 5)), minor_locator=NullLocator())
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_major_formatter("{x:g}")
            axes.set_title(", ".join(f"{PANEL[at]} {shape[at]}" for at in told), fontsize=9)
            axes.grid(which="major", color="0.9", linewidth=0.6)
        for axes in grid.flat[len(shapes) :]:
            axes.set_visible(False)
        figure.supxlabel("seconds on one thread", fontsize=9)
        figure.supylabel("filtered error, 1 is white noise", fontsize=9)
        legends = [zip(*axes.get_legend_handles_labels()) for axes in grid.flat]
        handles = {label: handle for legend in legends for handle, label in legend}
        figure.legend(
            [handles[kernel] for kernel in kernels],
            kernels,
            loc="outside upper center",
            ncols=min(len(kernels), 4),
            frameon=False,
        )
        figure.savefig(path)
    return sum(
        len(seeds) for curves in shapes.values() for budgets in curves.values() for seeds in budgets.values()
    )


#: Seconds and errors of all seeds by budget, by kernel, by panel.
Budgets = dict[str, list[tuple[float, float]]]
Panels = dict[tuple[Any, ...], dict[str, Budgets]]


def panels(tasks: Iterable[Task], rows: dict[str, Row]) -> Panels:
    """What is done, by shape, kernel and budget."""
    found: Panels = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for task in tasks:
        row = rows.get(task.key, {})
        # An axis in logarithms has no place for what is not above 0.
        if row.get("state") == "done" and row["seconds"] > 0 and row["error"] > 0:
            shape = tuple(str(task.labels[of]) if of == "domain" else task.labels[of] for of in PANEL)
            found[shape][task.labels["kernel"]][task.labels["budget"]].append((row["seconds"], row["error"]))
    return found


def points(budgets: Budgets) -> list[tuple[float, float, float, float]]:
    """Medians over seeds of seconds and error, and the least and largest error, by rising time."""
    found = []
    for seeds in budgets.values():
        seconds, errors = zip(*seeds)
        found.append((statistics.median(seconds), statistics.median(errors), min(errors), max(errors)))
    return sorted(found)


def _curve(axes: Any, curve: list[tuple[float, float, float, float]], number: int, kernel: str) -> None:
    seconds, errors, least, largest = zip(*curve)
    color, marker = COLORS[number % len(COLORS)], MARKERS[number % len(MARKERS)]
    axes.vlines(seconds, least, largest, color=color, linewidth=1.2, alpha=0.5)
    axes.plot(seconds, errors, color=color, marker=marker, markersize=4, linewidth=1.4, label=kernel)
