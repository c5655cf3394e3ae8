"""Sample tables whose Monte Carlo error is blue noise in space and time.

A renderer that takes its random numbers from such a table makes the errors of neighbouring pixels and frames
cancel under the filter that follows: the eye, a denoiser, temporal antialiasing.

>>> import fsot
>>> table = fsot.table(64, 64, sweeps=20)
>>> table.array.shape  # [frame, y, x, sample, dim], float32 in [0, 1)
(1, 64, 64, 1, 2)
>>> table.save("table.npy")

You can stop here.
"""

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
    __version__,
)
from ._make import table
from ._optimizer import Interrupted, Optimizer
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
    "Report",
    "Slices",
    "Step",
    "Table",
    "Target",
    "Term",
    "Until",
    "__version__",
    "import_table",
    "metrics",
    "table",
]
