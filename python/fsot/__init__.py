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
from ._fsot import Checkpoint, Config, Kernel, Report, Step, Until, __version__
from ._exchange import Exported, Imported, import_table
from ._make import table
from ._optimizer import Interrupted, Optimizer
from ._table import Table

__all__ = [
    "Checkpoint",
    "Config",
    "Exported",
    "Imported",
    "Interrupted",
    "Kernel",
    "Optimizer",
    "Report",
    "Step",
    "Table",
    "Until",
    "__version__",
    "import_table",
    "metrics",
    "table",
]
