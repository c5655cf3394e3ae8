"""Studies: complete, resumable, the rows of tables that anybody makes, and safe from crashes."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest
from study_tools import EXAMPLES, GRID, facts, lines, run, signals, study, toml  # noqa: F401

import fsot
from studies import engines, grid, plot, results, task


# Grids.


def test_lists_multiply_and_budgets_add(toml):
    tasks = grid.read(toml).tasks
    assert len(tasks) == len({each.key for each in tasks}) == 2 * 3 * 2
    assert [each.labels["seed"] for each in tasks] == sorted(each.labels["seed"] for each in tasks)
    assert {each.labels["budget"] for each in tasks} == {"sweeps:2", "sweeps:8"}
    assert {each.labels["kernel"] for each in tasks} == {"wide", "box"}


def test_grids_that_overlap_make_a_table_once(toml):
    toml.write_text(GRID + "[[grid]]\nkernel = 2.1\nwidth = 16\nheight = 8\nsweeps = [2, 4]\n")
    assert len(grid.read(toml).tasks) == 12 + 1


def test_keys_are_of_what_rows_depend_on(toml):
    def keys(text):
        toml.write_text(text)
        return {each.key for each in grid.read(toml).tasks}

    first = keys(GRID)
    # Names, order and places of kernels are not.
    assert (
        keys(GRID.replace("wide", "other").replace('["other", "box"]', '["box", { sigma = 2.1 }]')) == first
    )
    for change in [
        ("slices = 64", "slices = 65"),
        ("integrands = 4", "seed = 1"),
        ("16", "17"),
        ("2.1", "2.2"),
    ]:
        assert len(keys(GRID.replace(*change)) & first) in (0, 6)
        assert keys(GRID.replace(*change)) != first


def test_frames_and_taps_are_filtered_as_usual(toml):
    numpy.save(toml.with_name("kernel.npy"), [[0, 1, 0], [1, 2, 1], [0, 1, 0]])
    toml.write_text(
        '[[grid]]\nkernel = [2.1, { taps = "kernel.npy" }, { sigma = 2.1, temporal = "ema:0.1" }]\nframes = 4'
    )
    gaussian, own, ema = (fsot.Config.from_dict(each.work["config"]) for each in grid.read(toml).tasks)
    assert gaussian == fsot.Config(frames=4)
    assert ema.kernels == [fsot.Kernel.gaussian(2.1, temporal="ema:0.1")]
    assert len(own.kernels[0].taps(frames=1)) == 5
    assert own.kernels[0].to_dict()["temporal"] == gaussian.kernels[0].to_dict()["temporal"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", r"makes no tables: write a \[\[grid\]\]"),
        ("[[grid]]\nspp = ", "Invalid value"),
        ("[[grid]]\nsseds = 5", "'sseds' that is not known: did you mean 'seeds'"),
        ("[[grid]]\nseed = 1\nseeds = 5", "leave out one of them"),
        ("[[grid]]\nseeds = -5", "seeds is -5: write how many"),
        ("[[grid]]\nspp = []", "spp is an empty list"),
        ("[grid]\nspp = 1", r"write \[\[grid\]\]"),
        ('[kernels]\nwide = 2\n[[grid]]\nkernel = "wid"', "did you mean 'wide'"),
        ("[[grid]]\nkernel = { sigma = 1, box = 3 }", "2 shapes: give one of"),
        ('[[grid]]\nkernel = { taps = "nowhere.npy" }', "No such file"),
        ("[[grid]]\n[measure]\nintegrands = 0", "integrands is 0"),
        ("[[grid]]\n[local]\nworkers = 0", "workers is 0: give a whole number"),
        ("[[grid]]\n[slurm]\njobs = 1.5", "jobs is 1.5: give a whole number"),
        ("[[grid]]\n[measur]", "did you mean 'measure'"),
    ],
)
def test_slips_are_told_before_anything_is_made(toml, capsys, text, sentence):
    toml.write_text(text)
    assert run(toml) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("study: ") and re.search(sentence, line)
    assert not toml.with_suffix(".csv").exists()


# Rows.


def test_rows_are_of_the_tables_that_anybody_makes(toml):
    assert run(toml) == 0
    rows = results.load(toml.with_suffix(".csv"))
    for each in grid.read(toml).tasks:
        row = rows[each.key]
        kernel = fsot.Kernel.from_dict({"spatial": {"gaussian": {"sigma_px": 2.1}}})
        if each.labels["kernel"] == "box":
            kernel = fsot.Kernel.from_dict({"spatial": {"box": {"size_px": 3}}})
        sweeps = int(each.labels["budget"].removeprefix("sweeps:"))
        table = fsot.table(16, 8, kernel=kernel, seed=each.labels["seed"], sweeps=sweeps)
        table.save(toml.with_suffix(".npy"))
        assert row["sha256"] == json.loads(toml.with_suffix(".json").read_text())["sha256"]
        integrands = fsot.metrics.Integrands.random(2, 4)
        error = fsot.metrics.filtered_error(table, integrands=integrands, kernel=kernel)
        assert row["error"] == error.spatio_temporal.mean
        assert row["error.ball"] == error.spatio_temporal.families["ball"].mean
        assert row["bias"] == fsot.metrics.bias(table, integrands=integrands).table.mean
        config = fsot.Config.from_dict(json.loads(row["config"]))
        assert row["bound"] == fsot.metrics.bound(table, config, slices=64).ratio
        assert (row["state"], row["worker"], row["pid"]) == ("done", "serial", os.getpid())


def test_work_makes_the_table_of_some_seconds_again(toml):
    toml.write_text(
        "[[grid]]\nwidth = 16\nheight = 16\nseconds = 0.05\n[measure]\nintegrands = 2\nslices = 64\nunder = 1"
    )
    assert run(toml) == 0
    (row,) = results.load(toml.with_suffix(".csv")).values()
    optimizer = fsot.Optimizer(fsot.Config.from_dict(json.loads(row["config"])))
    optimizer.run(fsot.Until.from_dict(json.loads(row["work"])), progress=False)
    assert task.hashlib.sha256(optimizer.table().array.tobytes()).hexdigest() == row["sha256"]
    under = fsot.Kernel.from_dict({"spatial": {"gaussian": {"sigma_px": 1.0}}})
    assert row["bound"] == fsot.metrics.bound(optimizer.table(), kernel=under, slices=64).ratio


def test_what_is_done_is_not_done_again(toml):
    assert run(toml) == 0
    before = toml.with_suffix(".csv").read_bytes()
    assert run(toml) == 0
    assert toml.with_suffix(".csv").read_bytes() == before
    toml.write_text(GRID.replace("seeds = 3", "seeds = 4"))
    assert run(toml) == 0
    assert toml.with_suffix(".csv").read_bytes().startswith(before)
    assert lines(toml) == 1 + 16


def test_failures_are_written_down_and_tried_again(toml, capsys):
    toml.write_text(GRID.replace("width = 16", f'width = [16, 0, -1, 2.5, {10**30}, "wide\\nand \\" open"]'))
    assert run(toml) == 1
    rows = list(results.load(toml.with_suffix(".csv")).values())
    failed = [row for row in rows if row["state"] == "failed"]
    assert (len(rows), len(failed)) == (72, 60)
    assert {row["message"] for row in failed if row["width"] == 0} == {"width is 0: give at least 1"}
    assert all(row["message"] for row in failed)
    assert "60 tables failed" in capsys.readouterr().err
    assert run(toml) == 1
    assert lines(toml) == 1 + 72 + 60


def test_a_worker_of_another_version_refuses(toml):
    (first, *_) = grid.read(toml).tasks
    row = task.compute(first.work | {"fsot": "0.0.0"})
    assert row["state"] == "failed"
    assert "install the same" in row["message"]


def test_parquet_holds_the_last_row_of_each_key(toml):
    parquet = pytest.importorskip("pyarrow.parquet")
    toml.write_text(GRID.replace("width = 16", "width = [16, 0]"))
    run(toml)
    run(toml)
    table = parquet.read_table(toml.with_suffix(".parquet"))
    assert table.column_names == list(results.COLUMNS)
    assert table.num_rows == 24
    rows = results.load(toml.with_suffix(".csv"))
    assert {row["key"]: row["error"] for row in table.to_pylist()} == {
        key: row["error"] for key, row in rows.items()
    }


# Crashes.


def test_a_cut_line_is_made_again(toml, capsys):
    assert run(toml) == 0
    out = toml.with_suffix(".csv")
    whole, expected = out.read_bytes(), facts(out)
    last = whole.rfind(b"\n", 0, -1) + 1
    header = whole.find(b"\n")
    for length in [last + 1, last + 64, last + 65, len(whole) - 400, len(whole) - 1, header - 5, 1]:
        out.write_bytes(whole[:length])
        assert run(toml) == 0
        assert "was cut" in capsys.readouterr().err
        assert facts(out) == expected
        # Also for others.
        with open(out, newline="") as file:
            assert len(list(csv.DictReader(file))) == 12


def test_spoiled_lines_are_left_out_and_told(toml, capsys):
    assert run(toml) == 0
    out = toml.with_suffix(".csv")
    expected = facts(out)
    header, first, second, *rest = out.read_bytes().splitlines(keepends=True)
    out.write_bytes(b"".join([header, bytes(30) + b"\n", first[:90] + b'"\n', second, *rest]))
    assert run(toml) == 0
    assert "2 spoiled lines" in capsys.readouterr().err
    assert facts(out) == expected


def test_files_of_others_are_left_alone(toml, capsys):
    out = toml.with_suffix(".csv")
    for text in ["a,b,c\n1,2,3\n", ",".join(results.COLUMNS[:-1]) + "\n"]:
        out.write_text(text)
        assert run(toml) == 1
        assert "other columns" in capsys.readouterr().err
        assert out.read_text() == text


def test_a_full_disk_costs_half_a_line(toml, capsys):
    assert run(toml) == 0
    out = toml.with_suffix(".csv")
    expected = facts(out)
    room = len(out.read_bytes()) // 2
    out.unlink()
    script = f"import resource, sys; sys.path.insert(0, {str(EXAMPLES)!r}); import study\n"
    script += f"resource.setrlimit(resource.RLIMIT_FSIZE, ({room}, {room})); sys.exit(study.main())"
    arguments = [str(toml), "--out", str(out), "--serial", "--no-plot"]
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "rows that were written are kept" in done.stderr and "Traceback" not in done.stderr
    assert len(out.read_bytes()) == room
    assert run(toml) == 0
    assert "was cut" in capsys.readouterr().err
    assert facts(out) == expected


def test_two_studies_of_one_file_refuse_each_other(toml):
    out = toml.with_suffix(".csv")
    script = f"import sys; sys.path.insert(0, {str(EXAMPLES)!r}); from studies.results import *\n"
    script += f"with Results(Path({str(out)!r})): print(flush=True); input()"
    holder = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        holder.stdout.readline()
        with pytest.raises(grid.StudyError, match="another study appends"), results.Results(out):
            pass
    finally:
        holder.kill()
        holder.wait()
    with results.Results(out) as kept:
        assert not kept.latest


def test_an_interrupt_keeps_whole_tables_only(toml):
    (first, *_) = grid.read(toml).tasks
    long = grid.Task(first.key, first.labels, first.work | {"until": fsot.Until.seconds(60).to_dict()})
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        list(engines.serial([long]))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_study_that_is_ended_goes_on(toml, number):
    toml.write_text(GRID.replace("seeds = 3", "seeds = 300"))
    out = toml.with_suffix(".csv")
    command = [
        sys.executable,
        str(EXAMPLES / "study.py"),
        str(toml),
        "--out",
        str(out),
        "--serial",
        "--no-plot",
    ]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and (not out.exists() or lines(toml) < 20):
        time.sleep(0.01)
    process.send_signal(number)
    assert "the same command goes on" in process.communicate()[1]
    assert process.returncode == 130
    done = lines(toml)
    assert 20 <= done < 1201
    assert out.read_bytes().endswith(b"\n")
    toml.write_text(GRID)
    assert run(toml) == 0
    assert lines(toml) >= done


# Pictures.


def test_curves_are_medians_over_seeds(toml):
    pytest.importorskip("matplotlib")
    tasks = grid.read(toml).tasks
    rows = {
        each.key: {
            "state": "done",
            "seconds": 1.0 + each.labels["seed"],
            "error": 0.1 * 3 ** each.labels["seed"],
        }
        for each in tasks
    }
    rows[tasks[0].key]["state"] = "failed"
    picture = toml.with_suffix(".png")
    assert plot.draw(tasks, rows, picture) == 11
    assert picture.read_bytes().startswith(b"\x89PNG")
    (curves,) = plot.panels(tasks, rows).values()
    assert plot.points(curves["box"]) == [(2.0, pytest.approx(0.3), 0.1, pytest.approx(0.9))] * 2
    with pytest.raises(grid.StudyError, match="run the study first"):
        plot.draw(tasks, {}, picture)


def test_a_study_needs_no_picture(toml, capsys, monkeypatch):
    arguments = [str(toml), "--out", str(toml.with_suffix(".csv"))]
    assert study.main([*arguments, "--plot-only"]) == 1
    assert "run the study first" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert study.main([*arguments, "--serial"]) == 0
    assert "no picture: pictures need matplotlib" in capsys.readouterr().err
    assert study.main([*arguments, "--plot-only"]) == 1


@pytest.mark.parametrize(
    "line, words",
    [
        ("seconds = [nan]", "grid.seconds is nan: give a finite number"),
        ("kernel = [2.1, inf]", "grid.kernel is inf: give a finite number"),
        ("kernel = [{ sigma = nan }]", "grid.kernel.sigma is nan: give a finite number"),
        ("spp = 1979-05-27", "grid.spp is a date or a time, 1979-05-27: write"),
        ("seed = [07:32:00]", "grid.seed is a date or a time, 07:32:00: write"),
    ],
)
def test_values_of_no_table_are_refused_by_their_key(line, words, toml, capsys):
    toml.write_text(f"[[grid]]\nwidth = 8\n{line}\n")
    assert run(toml) == 1
    said = capsys.readouterr().err
    assert said.startswith("study: ") and words in said and said.count("\n") == 1


def test_a_task_takes_one_thread(toml, monkeypatch):
    # More would change no bit, and crowd the other workers of its machine.
    asked = []

    def spy(holder, name):
        made = getattr(holder, name)

        def call(*arguments, threads=None, **more):
            asked.append((name, threads))
            return made(*arguments, threads=threads, **more)

        monkeypatch.setattr(holder, name, call)

    spy(fsot, "Optimizer")
    for name in ("filtered_error", "bias", "bound"):
        spy(fsot.metrics, name)
    assert run(toml) == 0
    assert {name for name, _ in asked} == {"Optimizer", "filtered_error", "bias", "bound"}
    assert {threads for _, threads in asked} == {1}
