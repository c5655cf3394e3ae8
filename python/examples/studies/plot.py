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

    panels = _panels(tasks, rows)
    if not panels:
        raise StudyError("nothing is done that could be drawn: run the study first")
    columns = min(len(panels), 4 if len(panels) > 4 else 2)
    lines = -(-len(panels) // columns)
    with matplotlib.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(0.6 + 3.2 * columns, 0.9 + 2.5 * lines), layout="constrained", dpi=160)
        grid = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        kernels = sorted({kernel for curves in panels.values() for kernel in curves})
        varying = [
            at for at in range(len(PANEL)) if len({panel[at] for panel in panels}) > 1 or PANEL[at] in ("spp", "dims")
        ]
        for axes, (panel, curves) in zip(grid.flat, sorted(panels.items())):
            for number, kernel in enumerate(kernels):
                if kernel in curves:
                    _curve(axes, curves[kernel], number, kernel)
            axes.set(xscale="log", yscale="log")
            axes.set_title(", ".join(f"{PANEL[at]} {panel[at]}" for at in varying), fontsize=9)
            axes.grid(which="major", color="0.9", linewidth=0.6)
        for axes in list(grid.flat)[len(panels) :]:
            axes.set_visible(False)
        figure.supxlabel("seconds on one thread", fontsize=9)
        figure.supylabel("filtered error, 1 is white noise", fontsize=9)
        handles = {label: handle for axes in grid.flat for handle, label in zip(*axes.get_legend_handles_labels())}
        figure.legend(
            handles.values(), handles.keys(), loc="outside upper center", ncols=min(len(handles), 4), frameon=False
        )
        figure.savefig(path)
    return sum(len(points) for curves in panels.values() for budgets in curves.values() for points in budgets.values())


#: Seconds and errors of all seeds by budget, by kernel, by panel.
Budgets = dict[str, list[tuple[float, float]]]
Panels = dict[tuple[Any, ...], dict[str, Budgets]]


def _panels(tasks: Iterable[Task], rows: dict[str, Row]) -> Panels:
    panels: Panels = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for task in tasks:
        row = rows.get(task.key, {})
        # An axis in logarithms has no place for what is not above 0.
        if row.get("state") == "done" and row["seconds"] > 0 and row["error"] > 0:
            panel = tuple(str(task.labels[of]) if of == "domain" else task.labels[of] for of in PANEL)
            panels[panel][task.labels["kernel"]][task.labels["budget"]].append((row["seconds"], row["error"]))
    return panels


def _curve(axes: Any, budgets: Budgets, number: int, kernel: str) -> None:
    points = []
    for of_seeds in budgets.values():
        seconds, errors = zip(*of_seeds)
        points.append((statistics.median(seconds), statistics.median(errors), min(errors), max(errors)))
    x, y, low, high = zip(*sorted(points))
    color, marker = COLORS[number % len(COLORS)], MARKERS[number % len(MARKERS)]
    axes.vlines(x, low, high, color=color, linewidth=1.2, alpha=0.5)
    axes.plot(x, y, color=color, marker=marker, markersize=4, linewidth=1.4, label=kernel)
