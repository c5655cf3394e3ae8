"""What a second worker is worth, and what is lost when one dies.

    python benches/two_workers.py [GRID.toml]

Runs the sample study in one process, on two workers, and on two workers of which one is killed in the middle.
Fails if a row is missing, or says other values than the one that the single process has made. Prints wall
times, their ratios, the processor time of each and the load of the machine, which should be idle before.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

from studies import grid, results  # noqa: E402
from studies.task import Row  # noqa: E402

#: What a row says of its table, whoever made it and whenever.
FACTS = [
    column
    for column in results.COLUMNS
    if column not in ("seconds", "task_seconds", "finished", "host", "pid", "worker")
]


def main() -> None:
    """Measures, compares, prints."""
    toml = Path(sys.argv[1]) if len(sys.argv) > 1 else EXAMPLES / "study.toml"
    tables = len(grid.read(toml).tasks)
    print(f"{tables} tables of {toml.name}; load before {os.getloadavg()[0]:.2f}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        expected, serial = _run(toml, Path(folder, "serial.csv"), ["--serial"])
        print(f"in one process          {serial:6.1f} s", flush=True)
        for name, kills in (("two workers", False), ("two workers, one killed", True)):
            rows, seconds = _run(
                toml, Path(folder, f"{name}.csv"), ["--workers", "2"], tables // 2 if kills else 0
            )
            assert rows.keys() == expected.keys() and len(rows) == tables, "rows are missing"
            other = [key for key in rows if any(rows[key][fact] != expected[key][fact] for fact in FACTS)]
            assert not other, f"{len(other)} rows differ"
            processes = len({row["pid"] for row in rows.values()})
            assert processes == 2 + kills, f"rows are of {processes} processes"
            share = sum(row["task_seconds"] for row in rows.values()) / seconds
            print(
                f"{name:23} {seconds:6.1f} s, {serial / seconds:.2f} times as fast, {share:.2f} at a time",
                flush=True,
            )
    print(f"all rows are the same, to the last bit; load after {os.getloadavg()[0]:.2f}")


def _run(toml: Path, out: Path, where: list[str], kill_after: int = 0) -> tuple[dict[str, Row], float]:
    """Rows and seconds of a study, whose last worker to have finished a table is killed after so many."""
    command = [sys.executable, str(EXAMPLES / "study.py"), str(toml), "--out", str(out), "--no-plot", *where]
    # Workers are children that outlive no run: their time is the run's.
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as study:
        while kill_after and study.poll() is None:
            rows = results.load(out) if out.exists() and out.stat().st_size else {}
            if len(rows) >= kill_after:
                os.kill(list(rows.values())[-1]["pid"], signal.SIGKILL)
                break
            time.sleep(0.05)
        said = study.communicate()[1].decode()
    assert study.returncode == 0, said
    seconds = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"  {after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime:.1f} s of processors",
        end="; ",
    )
    return results.load(out), seconds


if __name__ == "__main__":
    main()
