"""One table: made and measured. This is what workers run; it imports nothing but `fsot` and what comes with Python."""

from __future__ import annotations

import datetime
import hashlib
import json
import os
import socket
import time
from typing import Any

Row = dict[str, Any]


def compute(work: dict[str, Any]) -> Row:
    """Makes and measures the table that `work` says, on one thread.

    The row depends on `work` alone, but for times and places; budgets in seconds are the exception, and
    ``row["work"]`` is what they came to. What goes wrong is a row too: ``state`` is then ``"failed"``, and
    ``message`` says why.
    """
    began = time.perf_counter()
    row: Row = {"state": "done", "message": ""}
    try:
        row |= _measured(work)
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic is no Exception
        row |= {"state": "failed", "message": sentence(error)}
    row["task_seconds"] = time.perf_counter() - began
    row["finished"] = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
    return row | {"host": socket.gethostname(), "pid": os.getpid(), "worker": _worker()}


def sentence(error: BaseException) -> str:
    """What an error says, in one line."""
    said = " ".join(str(error).split())
    if isinstance(error, (ValueError, OSError)) and said:
        return said
    return f"{type(error).__name__}: {said}" if said else type(error).__name__


def _measured(work: dict[str, Any]) -> Row:
    import fsot

    if fsot.__version__ != work["fsot"]:
        raise RuntimeError(
            f"fsot is {fsot.__version__} here and {work['fsot']} where the study began: install the same"
        )
    optimizer = fsot.Optimizer(fsot.Config.from_dict(work["config"]), threads=1)
    report = optimizer.run(fsot.Until.from_dict(work["until"]), progress=False)
    if report.ended == "stopped":
        # Ctrl-C leaves the optimiser with half a table, which is nobody's answer.
        raise KeyboardInterrupt
    array = optimizer.table().array
    row: Row = {
        "seconds": report.elapsed,
        "work": json.dumps(report.work.to_dict(), sort_keys=True),
        "sha256": hashlib.sha256(array.astype("<f4").tobytes()).hexdigest(),
    }
    return row | _figures(fsot, array, work)


def _figures(fsot: Any, array: Any, work: dict[str, Any]) -> Row:
    # PROVISIONAL until fsot.metrics is there
    import numpy

    e = (array.mean(axis=3)[..., 0] - 0.5) * numpy.sqrt(12.0 * array.shape[3])
    y, x = (numpy.minimum(numpy.arange(n), n - numpy.arange(n)) for n in e.shape[1:])
    w = numpy.exp(-(y[:, None] ** 2 + x**2) / 2.1**2)
    w /= w.sum()
    f = numpy.fft.ifft2(numpy.fft.fft2(e) * numpy.fft.fft2(w)).real
    error = float((f**2).mean() / (w**2).sum())
    return {"error": error, "error half-space": error, "error smooth": error, "error ball": error,
            "error box": error, "bias": error, "bound": error}


def _worker() -> str:
    try:
        from distributed import get_worker

        return str(get_worker().address)
    except (ImportError, ValueError):
        return "serial"
