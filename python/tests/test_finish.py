"""Runs that ended early go on to the bits of one that was left alone; metadata say what made a table."""

from __future__ import annotations

import copy
import os
import pathlib
import pickle
import signal
import subprocess
import sys

import numpy
import pytest

import fsot

STILL = fsot.Config(16, 16)
# 12 sweeps of its first frame come before all frames are swept.
ANIMATION = fsot.Config(16, 16, 4)
WORK = fsot.Until.work(frame_sweeps=12, slices=64, sweeps=6)


def alone(config):
    optimizer = fsot.Optimizer(config)
    report = optimizer.run(WORK, progress=False)
    return optimizer.table(), report


def end_by_false(optimizer, at):
    report = optimizer.run(WORK, lambda step: step.step < at, progress=False)
    assert (report.ended, report.steps) == ("stopped", at)


def end_by_exception(optimizer, at):
    def fail(step):
        if step.step == at:
            raise LookupError("enough")

    with pytest.raises(LookupError):
        optimizer.run(WORK, fail, progress=False)


def end_by_ctrl_c(optimizer, at):
    def interrupt(step):
        if step.step == at:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.warns(fsot.Interrupted):
        assert optimizer.run(WORK, interrupt, progress=False).ended == "stopped"


END = pytest.mark.parametrize("end", [end_by_false, end_by_exception, end_by_ctrl_c])
# In the first frame, in the slices, in the middle of a sweep.
PLACE = pytest.mark.parametrize(("config", "at"), [(STILL, 1), (STILL, 40), (ANIMATION, 5), (ANIMATION, 30)])


@END
@PLACE
def test_a_run_that_ended_early_is_finished(config, at, end):
    table, report = alone(config)
    optimizer = fsot.Optimizer(config)
    end(optimizer, at)
    early = optimizer.table()
    assert early.metadata["run"]["ended_early"] and early != table
    seen = []
    finished = optimizer.finish(lambda step: seen.append(step.step), progress=False)
    assert seen[0] in (at + 1, at + 2) and seen[-1] == report.steps
    assert (finished.ended, finished.steps, finished.work) == ("finished", report.steps, report.work)
    assert optimizer.table() == table
    for same in ("start", "frame_sweeps", "sweeps", "slices_per_class", "next_step", "next_sweep", "ended_early"):
        assert optimizer.table().metadata["run"].get(same) == table.metadata["run"].get(same)


@END
@PLACE
def test_its_checkpoint_is_finished_on_another_day(config, at, end, tmp_path):
    first = fsot.Optimizer(config)
    end(first, at)
    first.checkpoint().save(tmp_path / "run.checkpoint")
    # A copy: the run can be finished here as well.
    second = fsot.Optimizer(config)
    second.resume(fsot.Checkpoint.load(tmp_path / "run.checkpoint"))
    assert second.finish(progress=False).ended == "finished"
    assert first.finish(progress=False).ended == "finished"
    assert first.table() == second.table() == alone(config)[0]


def test_a_run_may_end_early_at_every_step():
    optimizer = fsot.Optimizer(ANIMATION)
    report = optimizer.run(WORK, lambda step: False, progress=False)
    while report.ended == "stopped":
        last = report.steps
        report = optimizer.finish(lambda step: False, progress=False)
        assert report.steps == last + 1 or report.ended == "finished"
    assert optimizer.table() == alone(ANIMATION)[0]


def left_alone(optimizer):
    optimizer.run(WORK, progress=False)


def put(optimizer):
    optimizer.points = optimizer.points


@pytest.mark.parametrize(
    "other",
    [
        left_alone,
        put,
        lambda optimizer: optimizer.step(),
        lambda optimizer: optimizer.sweep(),
        lambda optimizer: optimizer.resume(fsot.Optimizer(STILL).checkpoint()),
    ],
)
def test_what_else_moves_the_points_leaves_no_run(other):
    optimizer = fsot.Optimizer(STILL)
    end_by_false(optimizer, 9)
    other(optimizer)
    points = optimizer.points
    with pytest.raises(RuntimeError, match=r"no run to finish: begin one with run\(\)"):
        optimizer.finish(progress=False)
    again = fsot.Optimizer(STILL)
    again.resume(optimizer.checkpoint())
    assert numpy.array_equal(again.points, points) and numpy.array_equal(optimizer.points, points)
    with pytest.raises(RuntimeError, match="no run to finish"):
        again.finish(progress=False)


def test_what_is_refused_leaves_the_run():
    optimizer = fsot.Optimizer(STILL)
    end_by_false(optimizer, 9)
    with pytest.raises(ValueError):
        optimizer.run(fsot.Until.sweeps(10**12), progress=False)
    with pytest.raises(ValueError):
        optimizer.step(-1.0)
    with pytest.raises(ValueError):
        optimizer.points = numpy.ones((1, 2, 2, 1, 2))
    with pytest.raises(ValueError):
        optimizer.resume(fsot.Optimizer(ANIMATION).checkpoint())
    assert optimizer.finish(progress=False).ended == "finished"
    assert optimizer.table() == alone(STILL)[0]


def test_an_optimizer_that_has_not_run_has_nothing_to_finish():
    with pytest.raises(RuntimeError, match="no run to finish"):
        fsot.Optimizer(STILL).finish(progress=False)


def after_steps():
    optimizer = fsot.Optimizer(STILL)
    optimizer.step()
    return optimizer


def after_sweeps():
    optimizer = fsot.Optimizer(STILL)
    optimizer.sweep()
    return optimizer


def from_a_table():
    return fsot.Optimizer(STILL, start=alone(STILL)[0])


def from_an_array():
    return fsot.Optimizer(STILL, start=alone(STILL)[0].array)


def set_before():
    optimizer = fsot.Optimizer(STILL)
    put(optimizer)
    return optimizer


def in_the_middle():
    first, second = fsot.Optimizer(STILL), fsot.Optimizer(STILL)
    end_by_false(first, 9)
    second.resume(first.checkpoint())
    return second


def at_the_end_of_another():
    first, second = fsot.Optimizer(STILL), fsot.Optimizer(STILL)
    left_alone(first)
    second.resume(first.checkpoint())
    return second


def with_the_run_of_another():
    first, second = fsot.Optimizer(STILL), fsot.Optimizer(STILL)
    end_by_false(first, 9)
    second.run(fsot.Until.sweeps(2), progress=False)
    second.resume(first.checkpoint())
    return second


def with_a_run_before():
    optimizer = at_the_end_of_another()
    optimizer.run(fsot.Until.sweeps(2), progress=False)
    return optimizer


def again(optimizer, folder):
    """The table that the command makes of the metadata, or what it says."""
    table = optimizer.table()
    table.save(folder / "b.npy")
    told = subprocess.run(
        [sys.executable, "-m", "fsot", "table", "--config", "b.json", "--no-bound", "--out", "c.npy"],
        cwd=folder, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    if told.returncode == 0:
        return fsot.Table.load(pathlib.Path(folder) / "c.npy") == table
    return told.stderr


@pytest.mark.parametrize(
    "make",
    [
        after_steps,
        after_sweeps,
        from_a_table,
        from_an_array,
        set_before,
        in_the_middle,
        at_the_end_of_another,
        with_the_run_of_another,
        with_a_run_before,
    ],
)
def test_metadata_make_no_other_table(make, tmp_path):
    optimizer = make()
    assert optimizer.table().metadata["run"]["start"] == "elsewhere"
    assert "did not begin with the white noise of its seed" in again(optimizer, tmp_path)


def finished():
    optimizer = in_the_middle()
    optimizer.finish(progress=False)
    return optimizer


def of_a_fresh_checkpoint():
    optimizer = fsot.Optimizer(STILL)
    optimizer.run(fsot.Until.sweeps(2), progress=False)
    optimizer.resume(fsot.Optimizer(STILL).checkpoint())
    optimizer.run(fsot.Until.sweeps(3), progress=False)
    return optimizer


@pytest.mark.parametrize("make", [finished, of_a_fresh_checkpoint, lambda: fsot.Optimizer(STILL)])
def test_metadata_make_the_table_again(make, tmp_path):
    assert again(make(), tmp_path) is True


def forked(ask):
    """The exception of a child that is forked in a callback, by name, or how it ended."""
    found = []

    def fork(step):
        if step.step == 1:
            reader, writer = os.pipe()
            child = os.fork()
            if child == 0:
                signal.alarm(20)
                try:
                    ask(step)
                    told = b"nothing"
                except BaseException as error:
                    told = f"{type(error).__name__}: {error}".encode()
                os.write(writer, told)
                os._exit(0)
            os.close(writer)
            found.append(os.read(reader, 1000).decode())
            os.close(reader)
            os.waitpid(child, 0)

    optimizer = fsot.Optimizer(STILL)
    assert optimizer.run(fsot.Until.sweeps(1), fork, progress=False).ended == "finished"
    return found[0]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system does not fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning")
@pytest.mark.parametrize("ask", [lambda step: step.points, lambda step: step.loss, lambda step: step.checkpoint()])
def test_a_child_that_a_callback_forks_does_not_wait_for_its_parents_threads(ask):
    assert forked(ask).startswith("RuntimeError: the run is another process's")


def test_reports_and_figures_of_steps_are_copied_and_pickled():
    steps = []
    report = fsot.Optimizer(STILL).run(WORK, steps.append, progress=False)
    for same in (copy.copy, copy.deepcopy, lambda of: pickle.loads(pickle.dumps(of))):
        again = same(report)
        assert again == report and repr(again) == repr(report) and again.work == report.work
        step = same(steps[3])
        for figure in ("step", "steps", "slices", "displacement", "rate", "elapsed"):
            assert getattr(step, figure) == getattr(steps[3], figure)
        with pytest.raises(RuntimeError, match="ask a step while the callback sees it"):
            step.points  # noqa: B018
    assert report != fsot.Optimizer(STILL).run(fsot.Until.sweeps(1), progress=False)


@pytest.mark.parametrize("same", [copy.copy, copy.deepcopy, pickle.dumps])
def test_an_optimizer_says_what_to_pickle(same):
    with pytest.raises(TypeError, match=r"pickle optimizer\.checkpoint\(\) instead"):
        same(fsot.Optimizer(STILL))


def test_checkpoints_are_the_same_by_what_they_hold():
    optimizer = fsot.Optimizer(STILL)
    before = optimizer.checkpoint()
    assert before == optimizer.checkpoint() == pickle.loads(pickle.dumps(before)) == copy.copy(before)
    assert repr(before) == "<Checkpoint between runs>"
    end_by_false(optimizer, 9)
    checkpoint = optimizer.checkpoint()
    assert checkpoint != before and checkpoint == pickle.loads(pickle.dumps(checkpoint)) and checkpoint != 3
    assert repr(checkpoint).startswith("<Checkpoint at step 9 of Until.work(")


class Answer:
    dtype = numpy.dtype(bool)

    def __bool__(self):
        raise LookupError("no answer")


@pytest.mark.parametrize(
    ("answer", "error"),
    [(Answer(), LookupError), (numpy.array([False, False]), ValueError)],
)
def test_an_exception_of_an_answer_is_raised(answer, error):
    optimizer = fsot.Optimizer(STILL)
    with pytest.raises(error):
        optimizer.run(WORK, lambda step: answer, progress=False)
    assert optimizer.table().metadata["run"]["steps"] == 1
    assert optimizer.finish(progress=False).ended == "finished"


@pytest.mark.parametrize("answer", [numpy.array(False), numpy.array([False]), numpy.bool_(False)])
def test_false_of_numpy_ends_a_run(answer):
    assert fsot.Optimizer(STILL).run(WORK, lambda step: answer, progress=False).steps == 1


@pytest.mark.parametrize("answer", [numpy.array(True), numpy.array(0), numpy.float64(0), [], object()])
def test_no_other_answer_ends_a_run(answer):
    assert fsot.Optimizer(STILL).run(WORK, lambda step: answer, progress=False).ended == "finished"
