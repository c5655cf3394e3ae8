"""Sample tables whose Monte Carlo error is blue noise in space and time.

A renderer that takes its random numbers from such a table makes the errors of neighbouring pixels and frames
cancel under the filter that follows: the eye, a denoiser, temporal antialiasing.

>>> import fsot
>>> table = fsot.table(64, 64, sweeps=20)
>>> table.array.shape  # [frame, y, x, sample, dim], float32 in [0, 1)
(1, 64, 64, 1, 2)
>>> table.save("table.npy")

You can stop here. ``help(fsot.table)`` says what else it takes: several samples per pixel, frames, filters of
your own, a number of seconds.

What there is
-------------
`table`, `Table`
    A table in one call, and what it is: array, metadata, files, figures, pictures.
`metrics`
    What tables, arrays and points are worth, as ratios to white noise: filtered error, bias, spectra.
`import_table`, `Imported`, `Exported`
    Tables of other people's files; what was read, and what `Table.export` has written.
`classes`, `progressive`, `stippling`, `color_stippling`, `Points`
    Point sets: uniform alone and together, at every beginning, or as dense as a picture.
`Config`, `Kernel`
    All that determines a table but for the length of the run; a filter over pixels and frames.
`Optimizer`, `Until`, `Step`, `Report`
    A table on its way, how long, what a callback sees of it, and what was done. Ctrl-C ends a run and keeps
    what it had reached, with the warning `Interrupted`.
`Checkpoint`
    All that the rest of a run depends on, for another day.
`Demand`
    Pixels and dimensions that are used at all; the others are left alone.
`Term`, `Classes`, `Target`
    What an objective is a sum of: who is filtered together, and what their samples shall be like.
`Objective`, `Slices`
    Value and gradient of the filtered sliced distance, for optimisers of your own. `fsot.torch` and
    `fsot.jax` make a differentiable loss of it.
`BELOW_ONE`
    The greatest number of a table.

The command ``fsot``, also ``python -m fsot``, makes, measures, draws and exports tables in a terminal.

What it promises
----------------
The same seed gives the same bits on any number of threads. Numbers lie in ``[0, 1)``. Errors are
`ValueError`, `TypeError` and `OSError`, each with a sentence that ends in what to do. Work runs without the
interpreter's lock, so that several threads can each make a table, and arrays are handed over without a copy.
"""

from ._compiled import __version__  # first, since it has words for who misses it
from . import metrics
from ._exchange import Exported, Imported, import_table
from ._fsot import (
    BELOW_ONE,
    Checkpoint,
    Classes,
    Config,
    Demand,
    Kernel,
    Objective,
    Report,
    Slices,
    Step,
    Target,
    Term,
    Until,
)
from ._make import table
from ._optimizer import Interrupted, Optimizer
from ._point_sets import classes, color_stippling, progressive, stippling
from ._points import Points
from ._table import Table

__all__ = [
    "BELOW_ONE",
    "Checkpoint",
    "Classes",
    "Config",
    "Demand",
    "Exported",
    "Imported",
    "Interrupted",
    "Kernel",
    "Objective",
    "Optimizer",
    "Points",
    "Report",
    "Slices",
    "Step",
    "Table",
    "Target",
    "Term",
    "Until",
    "__version__",
    "classes",
    "color_stippling",
    "import_table",
    "metrics",
    "progressive",
    "stippling",
    "table",
]
