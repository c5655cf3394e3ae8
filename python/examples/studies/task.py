"""One table: made and measured. This is what workers run: it imports `fsot`, and what comes with Python."""

from __future__ import annotations

import datetime
import hashlib
import json
import os
import socket
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import fsot

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
    config = fsot.Config.from_dict(work["config"])
    optimizer = fsot.Optimizer(config, threads=1)
    report = optimizer.run(fsot.Until.from_dict(work["until"]), progress=False)
    if report.ended == "stopped":
        # Ctrl-C leaves the optimiser with half a table, which is nobody's answer.
        raise KeyboardInterrupt
    table = optimizer.table()
    return {
        "seconds": report.elapsed,
        "work": json.dumps(report.work.to_dict(), sort_keys=True),
        "sha256": hashlib.sha256(table.array.astype("<f4").tobytes()).hexdigest(),
        **_figures(table, config, work["measure"]),
    }


def _figures(table: fsot.Table, config: fsot.Config, measure: dict[str, Any]) -> Row:
    """What the table is worth, all its dimensions together, as ratios to white noise."""
    from fsot import Kernel, metrics

    if measure["under"] == "own":
        (kernel,) = config.kernels
        objective = config
    else:
        kernel = Kernel.from_dict(measure["under"])
        objective = None
    integrands = metrics.Integrands.random(config.shape[-1], measure["integrands"], seed=measure["seed"])
    error = metrics.filtered_error(table, integrands=integrands, kernel=kernel, threads=1)
    bias = metrics.bias(table, integrands=integrands, threads=1)
    bound = metrics.bound(
        table,
        objective,
        kernel=kernel if objective is None else None,
        slices=measure["slices"],
        seed=measure["seed"],
        threads=1,
    )
    of_families = {f"error.{family}": of.mean for family, of in error.spatio_temporal.families.items()}
    return {
        "error": error.spatio_temporal.mean,
        "error_se": error.spatio_temporal.standard_error,
        **of_families,
        "error_spatial": error.spatial.mean,
        "bias": bias.table.mean,
        "bound": bound.ratio,
    }


def _worker() -> str:
    try:
        from distributed import get_worker

        return str(get_worker().address)
    except (ImportError, ValueError):
        return "serial"
