"""Studies on workers: the same rows as in one process, whoever dies."""

import os
import signal
import time

import pytest
from study_tools import GRID, facts, lines, run, signals, study, toml  # noqa: F401

from studies import engines, grid, results, task

# Two clusters at once have dashboards at two ports.
pytestmark = pytest.mark.filterwarnings("ignore:Port 8787")


@pytest.fixture(scope="module")
def client():
    with engines.local(2, tries=2) as client:
        yield client


def test_a_killed_worker_costs_its_table_only(client, toml, tmp_path):
    assert run(toml) == 0
    expected = facts(toml.with_suffix(".csv"))
    gate = tmp_path / "gate"

    def gated(work):
        """From the fourth table on, nothing is done before a worker is dead."""
        while work["config"]["seed"] > 0 and not gate.exists():
            time.sleep(0.01)
        return task.compute(work)

    tasks = grid.read(toml).tasks
    out = tmp_path / "killed.csv"
    pids = []
    with results.Results(out) as kept:
        for each, row in engines.on_dask(client, tasks, gated, say=pids.append):
            kept.append(each, row)
            pids.append(row["pid"])
            if len(pids) == 4:
                assert not gate.exists()
                os.kill(row["pid"], signal.SIGKILL)
                gate.touch()
    assert facts(out) == expected
    assert lines(toml.with_name("killed.toml")) == 1 + 12


def test_a_table_that_kills_its_workers_fails_alone(client, toml):
    def poisonous(work):
        if work["config"]["seed"] == 1 and work["until"] == {"sweeps": 8}:
            os.kill(os.getpid(), signal.SIGKILL)
        return task.compute(work)

    toml.write_text(GRID.replace('kernel = ["wide", "box"]', 'kernel = "wide"'))
    rows = list(engines.on_dask(client, grid.read(toml).tasks, poisonous, say=lambda text: None))
    assert len(rows) == 6
    failed = [
        (each.labels["seed"], each.labels["budget"], row["message"])
        for each, row in rows
        if row["state"] != "done"
    ]
    assert failed == [
        (1, "sweeps:8", "its worker died each time: look for memory that is too little, or a limit of time")
    ]


def test_a_scheduler_that_runs_already_is_used(client, toml):
    out = toml.with_suffix(".csv")
    assert (
        study.main([str(toml), "--out", str(out), "--no-plot", "--scheduler", client.scheduler.address]) == 0
    )
    rows = results.load(out)
    assert len(rows) == 12
    assert all(row["worker"].startswith("tcp://") and row["pid"] != os.getpid() for row in rows.values())
    made = facts(out)
    out.unlink()
    assert run(toml) == 0
    assert facts(out) == made


def test_slurm_gets_a_worker_on_each_core(toml, capsys):
    pytest.importorskip("dask_jobqueue")
    toml.write_text(
        GRID + '[slurm]\njobs = 3\ncores = 16\nmemory = "32GB"\nqueue = "night"\nwalltime = "01:30:00"\n'
    )
    assert study.main([str(toml), "--job-script"]) == 0
    script = capsys.readouterr().out
    for part in [
        "#SBATCH -p night",
        "--cpus-per-task=16",
        "--mem=30G",
        "-t 01:30:00",
        "--nthreads 1",
        "--nworkers 16",
    ]:
        assert part in script
    toml.write_text(GRID + "[slurm]\ncores = 16\n")
    assert study.main([str(toml), "--job-script"]) == 1
    assert "memory" in capsys.readouterr().err


def test_jobs_of_slurm_make_the_same_rows(toml, tmp_path, monkeypatch):
    """A scheduler of jobs that knows two commands stands in for SLURM."""
    pytest.importorskip("dask_jobqueue")
    commands = tmp_path / "bin"
    commands.mkdir()
    # The script is gone as soon as it is submitted.
    sbatch = (
        'cp "$1" "$1.kept"; setsid sh "$1.kept" > /dev/null 2>&1 < /dev/null & echo "Submitted batch job $!"'
    )
    for name, script in {"sbatch": sbatch, "scancel": 'kill -- "-$1"'}.items():
        (commands / name).write_text(f"#!/bin/sh\n{script}\n")
        (commands / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(commands), prepend=os.pathsep)
    toml.write_text(GRID + '[slurm]\ncores = 1\nmemory = "1GB"\ninterface = "lo"\n')
    assert study.main([str(toml), "--out", str(tmp_path / "slurm.csv"), "--no-plot", "--slurm"]) == 0
    assert run(toml) == 0
    assert facts(tmp_path / "slurm.csv") == facts(toml.with_suffix(".csv"))
