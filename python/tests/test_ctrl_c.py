"""Ctrl-C in work that cannot be stopped."""

import os
import signal
import subprocess
import sys

import pytest

#: Longer than anybody waits; each would take minutes if it were not left alone.
WORK = {
    "discrepancy": "fsot.metrics.discrepancy(numpy.random.default_rng(0).random((1 << 20, 2)))",
    "inspect": "fsot.Table(big).inspect(integrands=1 << 12)",
    "report": "fsot.Table(big).report(sys.argv[1], integrands=1 << 12)",
    "taps": "fsot.Kernel.gaussian(1e5).taps(6000, 6000)",
}
SCRIPT = """
import os, signal, sys, threading, time
import numpy, fsot
big = numpy.random.default_rng(0).random((4, 256, 256, 4, 4), numpy.float32) if {big} else None
came = []
def interrupt():
    time.sleep(0.5)
    came.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
try:
    {work}
except KeyboardInterrupt:
    print(time.perf_counter() - came[0])
    # The next work has threads of its own.
    print(fsot.metrics.discrepancy([[0.5, 0.5]]).squared > 0)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a process to itself")
@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_leaves_alone_what_cannot_be_stopped(tmp_path, work):
    page = tmp_path / "page.html"
    script = SCRIPT.format(work=WORK[work], big="big" in WORK[work])
    done = subprocess.run(
        [sys.executable, "-c", script, page], capture_output=True, text=True, timeout=60, env=os.environ
    )
    # It also ends while the work goes on, and without a word.
    assert done.returncode == 0 and done.stderr == "", done
    seconds, next_one = done.stdout.split()
    # Noticed within 50 ms; the rest is for a busy machine.
    assert float(seconds) < 1.0
    assert next_one == "True"
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_of_a_handler_that_does_nothing_changes_nothing():
    import fsot

    before = signal.signal(signal.SIGALRM, lambda *_: None)
    signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
    try:
        points = [[(n + 0.5) / 20000, n * 0.618 % 1] for n in range(20000)]
        found = fsot.metrics.discrepancy(points).squared
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert found == fsot.metrics.discrepancy(points).squared
