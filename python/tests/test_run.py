"""Runs: that they are watched, stopped, interrupted, shared by threads and forked, and keep their result."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import warnings

import numpy
import pytest

import fsot


def small(**more):
    return fsot.table(16, 16, sweeps=10, progress=False, **more)


def test_a_callback_sees_every_step():
    seen = []
    table = small(callback=lambda step: seen.append((step.step, step.steps)))
    assert [step for step, _ in seen] == list(range(1, len(seen) + 1))
    assert {steps for _, steps in seen} == {len(seen)} == {table.metadata["run"]["steps"]}


def test_a_callback_changes_nothing():
    looked = small(callback=lambda step: (step.points, step.loss, step.checkpoint()) and None)
    assert looked == small()


def test_the_points_of_the_last_step_are_the_table_but_for_its_ranks():
    # A finished run of sweeps ends with exact ranks: 256 numbers move by a few 256ths at most.
    last = []
    table = small(callback=lambda step: last.append(step.points) if step.step == step.steps else None)
    assert 0 < numpy.abs(last[0] - table.array).max() < 4 / 256


def test_false_ends_a_run_and_nothing_else_does():
    table = small(callback=lambda step: step.step < 5)
    assert table.metadata["run"]["ended_early"] and table.metadata["run"]["steps"] == 5
    for answer in (None, True, 0, 1, "", numpy.bool_(True)):
        assert not small(callback=lambda step, answer=answer: answer).metadata["run"]["ended_early"]


def test_numpys_false_ends_a_run_too():
    assert small(callback=lambda step: numpy.bool_(False)).metadata["run"]["steps"] == 1


def test_an_exception_of_a_callback_is_raised_and_the_optimizer_keeps_its_points():
    optimizer = fsot.Optimizer(fsot.Config(16, 16))
    before = optimizer.points

    def fail(step):
        if step.step == 7:
            raise LookupError("seen enough")

    with pytest.raises(LookupError, match="seen enough"):
        optimizer.run(fsot.Until.sweeps(10), fail, progress=False)
    assert not numpy.array_equal(optimizer.points, before)
    assert optimizer.table().metadata["run"]["steps"] == 7
    assert optimizer.run(fsot.Until.sweeps(2), progress=False).ended == "finished"


def test_what_is_no_function_is_refused_by_its_call():
    with pytest.raises(TypeError):
        small(callback=3)


def test_a_step_answers_while_its_callback_sees_it_only():
    kept = []
    small(callback=kept.append)
    assert kept[0].step == 1 and kept[0].elapsed >= 0 and kept[0].slices == 0 and kept[0].rate > 0
    for ask in (lambda: kept[0].points, lambda: kept[0].loss, kept[0].checkpoint):
        with pytest.raises(RuntimeError, match="ask a step while the callback sees it"):
            ask()


def test_the_loss_falls():
    losses = []
    fsot.table(32, 32, sweeps=20, progress=False, callback=lambda step: losses.append(step.loss))
    # Noise of the estimate is a few per cent; twenty sweeps take a tenth and more of the loss of the first.
    assert losses[-1] < 0.9 * losses[0]


def test_an_optimizer_that_runs_says_so():
    optimizer = fsot.Optimizer(fsot.Config(16, 16))
    asked = []

    def ask(step):
        for what in (lambda: optimizer.points, lambda: optimizer.step(), lambda: optimizer.table()):
            with pytest.raises(RuntimeError, match="the optimiser is running"):
                what()
            asked.append(what)

    optimizer.run(fsot.Until.sweeps(1), ask, progress=False)
    assert asked


def test_a_run_may_start_another():
    # Also where one thread is all that there is, which the outer run holds.
    inside = []

    def nest(step, depth=3):
        if step.step == 3 and depth:
            inside.append(small(threads=1, callback=lambda step: nest(step, depth - 1)))

    assert small(threads=1, callback=nest) == small()
    assert inside == 3 * [small()]


def test_a_run_that_starts_itself_ends():
    def again(step):
        small(threads=1, callback=again)

    with pytest.raises(RecursionError, match="inside of each other"):
        again(None)
    # All that they had is given back.
    for _ in range(200):
        small(threads=1)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_change_nothing(threads):
    assert small(threads=threads) == small()
    assert small(frames=4, spp=2, dims=4, threads=threads) == small(frames=4, spp=2, dims=4)


@pytest.mark.parametrize("threads", [0, -1, 100_000, 2**70])
def test_a_number_of_threads_is_refused(threads):
    with pytest.raises(ValueError, match="give a"):
        small(threads=threads)


def test_several_threads_may_each_run_an_optimizer():
    tables = {}

    def make(seed):
        tables[seed] = small(seed=seed, callback=lambda step: None)

    workers = [threading.Thread(target=make, args=(seed,)) for seed in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert tables == {seed: small(seed=seed) for seed in range(8)}


def test_the_lock_is_released():
    # A thread of Python counts while the run works; with the lock held it would not begin.
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    try:
        fsot.table(64, 64, seconds=0.3, progress=False)
        optimizer = fsot.Optimizer(fsot.Config(64, 64, 10))
        while_stepping = counted
        for _ in range(20):
            optimizer.sweep()
    finally:
        done.set()
        counter.join()
    # A tenth of what an idle machine would count in .3 s.
    assert while_stepping >= 20 and counted > while_stepping


def _make(seed):
    return fsot.table(16, 16, sweeps=10, seed=seed, progress=False).array


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system does not fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_child_works_though_its_parent_has_worked():
    here = _make(3)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        there = pool.map_async(_make, [3, 3]).get(timeout=60)
    assert all(numpy.array_equal(one, here) for one in there)


def test_a_spawned_child_works():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.map_async(_make, [3]).get(timeout=60)
    assert numpy.array_equal(there[0], _make(3))


INTERRUPTED = """
import os, signal, sys, threading, time, warnings
import fsot

def soon():
    time.sleep(0.3)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=soon).start()
begin = time.monotonic()
"""


def run(script, *flags):
    code = INTERRUPTED + textwrap.dedent(script)
    return subprocess.run(
        [sys.executable, *flags, "-c", code], capture_output=True, text=True, timeout=60, check=False
    )


def test_ctrl_c_ends_a_run_and_keeps_its_result():
    found = run("""
        table = fsot.table(64, 64, seconds=1000, progress=False)
        run = table.metadata["run"]
        print(run["ended_early"], run["steps"] > 10, time.monotonic() - begin < 10)
    """)
    assert found.stdout.split() == ["True", "True", "True"], found.stderr
    assert "Interrupted: interrupted after" in found.stderr and "Traceback" not in found.stderr


def test_ctrl_c_is_an_exception_for_who_wants_it():
    found = run("""
        warnings.simplefilter("error", fsot.Interrupted)
        fsot.table(64, 64, seconds=1000, progress=False)
    """)
    assert found.returncode == 1 and found.stderr.rstrip().splitlines()[-1].startswith("fsot._optimizer.Interrupted")


def test_ctrl_c_ends_a_run_with_a_callback_that_sleeps():
    found = run("""
        optimizer = fsot.Optimizer(fsot.Config(64, 64))
        report = optimizer.run(fsot.Until.seconds(1000), lambda step: time.sleep(0.05))
        print(report.ended, report.steps, optimizer.table().metadata["run"]["ended_early"])
    """)
    ended, steps, early = found.stdout.split()
    assert (ended, early) == ("stopped", "True") and int(steps) < 40, found.stderr


def test_ctrl_c_while_it_plans_is_a_plain_interrupt():
    found = run("""
        import numpy
        # Planning a large lattice takes longer than the time until the signal.
        while True:
            fsot.Optimizer(fsot.Config(512, 512, 1, 1, 6))
    """)
    assert found.returncode != 0 and "KeyboardInterrupt" in found.stderr


def test_a_handler_of_ones_own_is_called_during_a_run():
    # Its run goes on to its end: the handler raises nothing.
    found = run("""
        called = []
        signal.signal(signal.SIGINT, lambda *_: called.append(1))
        table = fsot.table(64, 64, seconds=2, progress=False)
        print(len(called), table.metadata["run"]["ended_early"])
    """)
    assert found.stdout.split() == ["1", "False"], found.stderr


def test_a_run_on_another_thread_is_left_alone_by_ctrl_c():
    found = run("""
        tables = []
        done = threading.Event()
        def work():
            tables.append(fsot.table(16, 16, seconds=1, progress=False))
            done.set()
        threading.Thread(target=work).start()
        try:
            done.wait()
        except KeyboardInterrupt:
            done.wait()
        print(len(tables), tables[0].metadata["run"]["ended_early"])
    """)
    assert found.stdout.split() == ["1", "False"], found.stderr


def test_checkpoints_go_on_to_the_same_bits(tmp_path):
    path = tmp_path / "run.checkpoint"
    config = fsot.Config(16, 16, 4)
    first = fsot.Optimizer(config)
    first.run(
        fsot.Until.sweeps(10),
        lambda step: step.checkpoint().save(path) or False if step.step == 40 else None,
        progress=False,
    )
    checkpoint = fsot.Checkpoint.load(path)
    assert checkpoint.config == config
    second = fsot.Optimizer(checkpoint.config)
    second.resume(checkpoint)
    assert second.finish(progress=False).ended == "finished"
    alone = fsot.Optimizer(config)
    alone.run(fsot.Until.sweeps(10), progress=False)
    assert numpy.array_equal(second.points, alone.points)


def test_a_checkpoint_is_refused_by_another_configuration(tmp_path):
    checkpoint = fsot.Optimizer(fsot.Config(16, 16)).checkpoint()
    with pytest.raises(ValueError, match="."):
        fsot.Optimizer(fsot.Config(16, 16, seed=1)).resume(checkpoint)
    with pytest.raises(FileNotFoundError):
        fsot.Checkpoint.load(tmp_path / "nothing")
    damaged = bytearray(checkpoint.to_bytes())
    damaged[len(damaged) // 2] ^= 1
    with pytest.raises(ValueError):
        fsot.Checkpoint.from_bytes(bytes(damaged))


def test_the_work_of_a_report_makes_the_table_again():
    first = fsot.Optimizer(fsot.Config(16, 16))
    report = first.run(fsot.Until.seconds(0.05), progress=False)
    second = fsot.Optimizer(fsot.Config(16, 16))
    second.run(report.work, progress=False)
    assert numpy.array_equal(first.points, second.points)


def test_steps_and_sweeps_of_ones_own():
    optimizer = fsot.Optimizer(fsot.Config(16, 16))
    assert optimizer.step(1.0) > 0 and optimizer.sweep(1.0) > 0
    pulls = [optimizer.sweep(0.5) for _ in range(30)]
    assert pulls[-1] < pulls[0]
    for rate in (-1.0, float("nan"), 1e9):
        with pytest.raises(ValueError, match="from 0 to 1e6"):
            optimizer.step(rate)


def test_points_are_copies_and_can_be_set():
    optimizer = fsot.Optimizer(fsot.Config(8, 8))
    points = optimizer.points
    points[:] = 0.25
    assert optimizer.points.min() < 0.25 < optimizer.points.max()
    optimizer.points = points
    assert (optimizer.points == 0.25).all()


def test_a_table_goes_on_with_the_random_numbers_after_its_own():
    config = fsot.Config(16, 16)
    first = fsot.Optimizer(config)
    first.run(fsot.Until.slices(32), progress=False)
    table = first.table()
    first.run(fsot.Until.slices(32), progress=False)
    second = fsot.Optimizer(config, start=table)
    assert numpy.array_equal(second.points, table.array)
    second.run(fsot.Until.slices(32), progress=False)
    assert numpy.array_equal(second.points, first.points)
    # Numbers alone don't say where their run ended.
    third = fsot.Optimizer(config, start=table.array)
    third.run(fsot.Until.slices(32), progress=False)
    assert not numpy.array_equal(third.points, first.points)


@pytest.mark.parametrize(
    ("points", "error", "sentence"),
    [
        (numpy.zeros((1, 8, 8, 1, 3)), ValueError, "shape"),
        (numpy.full((1, 8, 8, 1, 2), 1.0), ValueError, r"values must lie in \[0, 1\)"),
        (numpy.full((1, 8, 8, 1, 2), numpy.nan), ValueError, "NaN"),
        (numpy.zeros((8, 8, 2)), ValueError, "give the five axes"),
        (numpy.zeros((1, 8, 8, 1, 2), complex), TypeError, "give real numbers"),
        ("points", TypeError, "give real numbers"),
        ([[1, 2], [3]], TypeError, "no array of numbers"),
        (None, TypeError, "give real numbers"),
        (numpy.float32(0.5), ValueError, "give the five axes"),
        (numpy.zeros((0, 8, 8, 1, 2)), ValueError, "frames"),
    ],
)
def test_foreign_points_are_refused(points, error, sentence):
    optimizer = fsot.Optimizer(fsot.Config(8, 8))
    before = optimizer.points
    with pytest.raises(error, match=sentence):
        optimizer.points = points
    assert numpy.array_equal(optimizer.points, before)


@pytest.mark.parametrize(
    "change",
    [
        lambda points: points.astype(">f4"),
        lambda points: points.astype(numpy.float64),
        lambda points: points.astype(numpy.float16),
        numpy.asfortranarray,
        lambda points: points[:, ::-1][:, ::-1],
        lambda points: numpy.repeat(points, 2, axis=2)[:, :, ::2],
        lambda points: points.tolist(),
        lambda points: numpy.frombuffer(points.tobytes(), numpy.float32).reshape(points.shape),
        lambda points: numpy.ma.masked_array(points),
    ],
    ids=["swapped", "double", "half", "fortran", "negative", "strided", "list", "read-only", "masked"],
)
def test_foreign_arrays_are_converted(change):
    points = fsot.table(8, 8, sweeps=1, progress=False).array.astype(numpy.float16).astype(numpy.float32)
    optimizer = fsot.Optimizer(fsot.Config(8, 8))
    optimizer.points = change(points)
    assert numpy.array_equal(optimizer.points, points)


def test_progress_is_shown_on_a_terminal_alone(capsys):
    fsot.table(32, 32, seconds=0.3)
    assert capsys.readouterr() == ("", "")


@pytest.mark.skipif(sys.platform == "win32", reason="terminals are made by pty")
def test_progress_is_shown_on_a_terminal():
    import fcntl
    import pty
    import struct
    import termios

    process, terminal = pty.fork()
    if process == 0:
        # A window of 24 rows and 80 columns; a bar of no width is empty.
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        os.execv(sys.executable, [sys.executable, "-c", "import fsot; fsot.table(64, 64, seconds=1)"])
    shown = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == 0, shown
    assert b"steps" in shown and b"%" in shown


def test_seconds_and_amounts_say_the_same_thing_twice():
    with pytest.raises(ValueError, match="leave out one of them"):
        fsot.table(8, 8, seconds=1, sweeps=1)


@pytest.mark.parametrize("seconds", [-1.0, 0.0, float("nan"), float("inf")])
def test_a_time_is_refused(seconds):
    with pytest.raises(ValueError):
        fsot.table(8, 8, seconds=seconds, progress=False)


def test_one_warning_of_ctrl_c_is_a_user_warning():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        fsot.table(64, 64, seconds=1000, progress=False)
    assert [warning.category for warning in caught] == [fsot.Interrupted]
    # It points at the line that called.
    assert caught[0].filename == __file__
