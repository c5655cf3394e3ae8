"""Rows in a CSV file, one to a table, that only grows."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from filelock import FileLock, Timeout

from .grid import StudyError, Task
from .task import Row

#: Families of integrands under which tables are measured.
FAMILIES = ("half-space", "smooth", "ball", "box")
INTEGERS = ("width", "height", "frames", "spp", "dims", "seed", "pid")
FLOATS = (
    "seconds",
    "error",
    "error_se",
    *(f"error.{family}" for family in FAMILIES),
    "error_spatial",
    "bias",
    "bound",
    "task_seconds",
)
COLUMNS = (
    *("key", "state", "message", "kernel", "width", "height", "frames", "spp", "dims", "domain", "seed"),
    *("budget", *FLOATS[:-1], "sha256", "work", "task_seconds"),
    *("finished", "host", "pid", "worker", "fsot", "measure", "config"),
)


class Results:
    """A file of rows that this process alone appends to, for use in a ``with`` statement.

    A row is one line, written in one piece and flushed to the disk. A line that a crash has cut is taken away
    when the file is opened again; lines that are no rows for other reasons are left alone and counted as
    `spoiled`.
    """

    def __init__(self, path: Path):
        self.path = path
        self._lock = FileLock(f"{path}.lock", timeout=0)
        self.latest: dict[str, Row] = {}
        self.spoiled = 0
        self.cut = False

    def __enter__(self) -> Results:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            self._lock.acquire()
        except Timeout:
            raise StudyError(
                f"another study appends to {self.path}: wait for its end, or give another file with --out"
            ) from None
        try:
            self._open()
        except BaseException:
            self._lock.release()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._lock.release()

    def append(self, task: Task, row: Row) -> None:
        """Writes what came of a task."""
        row = {
            **task.labels,
            "key": task.key,
            "fsot": task.work["fsot"],
            "measure": json.dumps(task.work["measure"], sort_keys=True),
            "config": json.dumps(task.work.get("config"), sort_keys=True),
            **row,
        }
        # Names and sentences must not break a line.
        line = self._write(" ".join(str(row.get(column, "")).split()) for column in COLUMNS)
        # What is known is what would be read.
        self.latest[task.key] = _row(line)

    def is_done(self, task: Task) -> bool:
        """Whether a task has its row, and needs no other."""
        return self.latest.get(task.key, {}).get("state") == "done"

    def _open(self) -> None:
        self._file = open(self.path, "ab+", buffering=0)
        try:
            self._file.seek(0)
            text = self._file.read()
            whole = text.rfind(b"\n") + 1
            if whole < len(text):
                self.cut = True
                self._file.truncate(whole)
            if whole == 0:
                self._write(COLUMNS)
                return
            self.latest, self.spoiled = parsed(text[:whole], self.path)
        except BaseException:
            self._file.close()
            raise

    def _write(self, values: Iterable[str]) -> str:
        text = io.StringIO()
        csv.writer(text, lineterminator="").writerow(values)
        line = text.getvalue().encode("utf-8", errors="backslashreplace")
        left = line + b"\n"
        while left:
            left = left[self._file.write(left) :]
        os.fsync(self._file.fileno())
        return line.decode()


def load(path: Path) -> dict[str, Row]:
    """The last row of every key, while others may append."""
    try:
        text = path.read_bytes()
    except OSError as error:
        raise StudyError(f"{path}: {error.strerror}: run the study first") from error
    return parsed(text[: text.rfind(b"\n") + 1], path)[0]


def parsed(text: bytes, path: Path) -> tuple[dict[str, Row], int]:
    """The last row of every key in whole lines, and how many lines are no rows."""
    header, *lines = text.decode("utf-8", errors="replace").split("\n")[:-1] or [""]
    if header != ",".join(COLUMNS):
        raise StudyError(f"{path} has other columns than this study: move it away, or give another file")
    latest: dict[str, Row] = {}
    spoiled = 0
    for line in lines:
        try:
            row = _row(line)
        except (ValueError, csv.Error):
            spoiled += 1
            continue
        latest[row["key"]] = row
    return latest, spoiled


def _row(line: str) -> Row:
    # Line by line: a quote that a crash has left open must not swallow what follows.
    (values,) = csv.reader([line], strict=True)
    row: Row = dict(zip(COLUMNS, values, strict=True))
    if row["state"] not in ("done", "failed") or len(row["key"]) != 64:
        raise ValueError("no row")
    for columns, kind in ((INTEGERS, int), (FLOATS, float)):
        for column in columns:
            row[column] = _number(kind, row[column], row["state"] == "failed")
    return row


def _number(kind: type[int] | type[float], text: str, may_lack: bool) -> int | float | None:
    """A number of a row; `None` in failed rows, which may have failed because it is none."""
    try:
        number = kind(text)
        if kind is int and not 0 <= number < 1 << 64:
            raise ValueError(f"{text} is out of range")
    except ValueError:
        if may_lack:
            return None
        raise
    return number


def save_parquet(rows: Iterable[Row], path: Path) -> bool:
    """Writes rows as Parquet, all or nothing; false without pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return False
    rows = list(rows)
    columns = {}
    for column in COLUMNS:
        values = [row.get(column) for row in rows]
        if column in INTEGERS:
            columns[column] = pyarrow.array(values, pyarrow.uint64())
        elif column in FLOATS:
            columns[column] = pyarrow.array(values, pyarrow.float64())
        else:
            columns[column] = pyarrow.array([str(value or "") for value in values], pyarrow.string())
    unfinished = path.with_name(f".{path.name}.tmp")
    try:
        pyarrow.parquet.write_table(pyarrow.table(columns), unfinished)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
    return True
