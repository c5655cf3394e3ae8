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
`table`
    makes a table in one call; `Table` is one: array, metadata, files, figures, pictures.
`Config`
    all that determines a table but for the length of the run; `Kernel` is a filter.
`Optimizer`
    a table on its way, for `Until` says how long. A callback sees each `Step`; a `Report` says what was done.
    Ctrl-C ends a run and keeps what it had reached, with the warning `Interrupted`; `Checkpoint` carries a
    run over to another day.

The command ``fsot``, also ``python -m fsot``, makes, measures, draws and exports tables in a terminal.

What it promises ---------------- The same seed gives the same bits on any number of threads. Numbers lie in
``[0, 1)``. Errors are `ValueError`, `TypeError` and `OSError`, each with a sentence that ends in what to do.
Work runs without the interpreter's lock, so that several threads can each make a table, and arrays are handed
over without a copy.
"""

from ._compiled import __version__
from ._fsot import Checkpoint, Config, Kernel, Report, Step, Until
from ._make import table
from ._optimizer import Interrupted, Optimizer
from ._table import Table

__all__ = [
    "Checkpoint",
    "Config",
    "Interrupted",
    "Kernel",
    "Optimizer",
    "Report",
    "Step",
    "Table",
    "Until",
    "__version__",
    "table",
]
