"""Makes and measures many tables: on the cores of this machine, or on the machines of a cluster.

    python study.py study.toml                        # a worker on each core
    python study.py study.toml --serial               # the same rows, in this process
    python study.py study.toml --scheduler tcp://…    # workers of a scheduler of Dask that runs already
    python study.py study.toml --slurm                # workers in jobs of SLURM

The file says what is made. Rows go to a CSV file as they come. What is done is not done again: after Ctrl-C,
a crash, or a change of the file, the same command goes on.
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
from collections.abc import Generator, Sequence
from pathlib import Path

from tqdm import tqdm

from studies import engines, plot, results
from studies.grid import Study, StudyError, Task, read
from studies.task import Row


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command, and returns its exit code."""
    options = _parser().parse_args(arguments)
    # An end by SLURM or `kill` is as good as Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return _study(options)
    except StudyError as error:
        print(f"study: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"study: {error}: rows that were written are kept; mend that and start again", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("study: ended early; what is done is kept, and the same command goes on", file=sys.stderr)
        return 130


def _study(options: argparse.Namespace) -> int:
    study = read(options.grid)
    if options.job_script:
        with engines.slurm_cluster(study.slurm) as cluster:
            print(cluster.job_script())
        return 0
    out = options.out or Path("out", options.grid.stem).with_suffix(".csv")
    if options.plot_only:
        return _draw(study, results.load(out), out)
    with results.Results(out) as kept:
        if kept.cut:
            print(f"the last line of {out} was cut by a crash: its table is made again", file=sys.stderr)
        if kept.spoiled:
            print(f"{out} has {kept.spoiled} spoiled lines, which are left out", file=sys.stderr)
        left = [task for task in study.tasks if not kept.is_done(task)]
        failed = _run(study, left, kept, options)
        rows = [kept.latest[task.key] for task in study.tasks]
    if results.save_parquet(rows, out.with_suffix(".parquet")):
        print(f"{len(rows)} rows in {out} and {out.with_suffix('.parquet')}")
    else:
        print(f"{len(rows)} rows in {out}")
    for task in failed[:10]:
        print(f"failed: {task.labels}: {kept.latest[task.key]['message']}", file=sys.stderr)
    if failed:
        print(f"{len(failed)} tables failed; the same command tries them again", file=sys.stderr)
    if not options.no_plot:
        try:
            _draw(study, kept.latest, out)
        except StudyError as error:
            # What was asked for is there.
            print(f"no picture: {error}", file=sys.stderr)
    return 1 if failed else 0


def _run(study: Study, left: list[Task], kept: results.Results, options: argparse.Namespace) -> list[Task]:
    """Does what is left, and returns what has failed."""
    failed = []
    bar = tqdm(
        total=len(study.tasks), initial=len(study.tasks) - len(left), unit=" tables", dynamic_ncols=True
    )
    # A log wants fewer lines than a terminal.
    bar.mininterval = 0.1 if sys.stderr.isatty() else 10
    with bar:
        refused = [task for task in left if task.refusal]
        outcomes = _outcomes(study, [task for task in left if not task.refusal], options, bar)
        for task in refused:
            kept.append(task, {"state": "failed", "message": task.refusal})
            failed.append(task)
            bar.update()
        with contextlib.closing(outcomes):
            for task, row in outcomes:
                kept.append(task, row)
                if row["state"] == "failed":
                    failed.append(task)
                    bar.set_postfix(failed=len(failed), refresh=False)
                bar.update()
    return failed


def _outcomes(
    study: Study, tasks: list[Task], options: argparse.Namespace, bar: tqdm[None]
) -> Generator[engines.Outcome, None, None]:
    if not tasks:
        return
    if options.serial:
        yield from engines.serial(tasks)
        return
    if options.scheduler:
        cluster = engines.existing(options.scheduler)
    elif options.slurm:
        cluster = engines.slurm(study.slurm, options.tries)
    else:
        cluster = engines.local(options.workers or study.local.get("workers"), options.tries)
    with cluster as client:
        bar.write(engines.dashboard(client), file=sys.stderr)
        yield from engines.on_dask(client, tasks, say=lambda text: bar.write(text, file=sys.stderr))


def _draw(study: Study, rows: dict[str, Row], out: Path) -> int:
    picture = out.with_suffix(".png")
    count = plot.draw(study.tasks, rows, picture)
    print(f"{picture}: {count} tables")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "grid", type=Path, help="a TOML file: study.toml beside this script explains its keys"
    )
    parser.add_argument("--out", type=Path, help="CSV file that rows are appended to [out/GRID.csv]")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--serial", action="store_true", help="in this process, without Dask")
    where.add_argument("--workers", type=_positive, help="so many workers on this machine [one a core]")
    where.add_argument("--scheduler", metavar="ADDRESS", help="on the workers of this scheduler")
    where.add_argument("--slurm", action="store_true", help="in jobs of SLURM, as [slurm] says")
    where.add_argument("--job-script", action="store_true", help="print the script of such a job, and end")
    where.add_argument("--plot-only", action="store_true", help="draw what is done, and end")
    parser.add_argument("--no-plot", action="store_true", help="draw nothing")
    parser.add_argument(
        "--tries", type=_positive, default=engines.TRIES, help="workers that a table may cost [%(default)s]"
    )
    return parser


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is too few: give at least 1")
    return number


if __name__ == "__main__":
    sys.exit(main())
