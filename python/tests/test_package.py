"""The package as it is installed: its version, its command, its help, what an import costs."""

from __future__ import annotations

import doctest
import importlib
import importlib.metadata
import inspect
import io
import os
import pkgutil
import pydoc
import re
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import numpy
import pytest

import fsot

HERE = Path(__file__).resolve().parents[1]
# Of what is imported where it is used, and of what that brings.
HEAVY = ["dask", "distributed", "jax", "matplotlib", "pandas", "PIL", "torch", "tqdm"]
MODULES = [f"fsot.{module.name}" for module in pkgutil.iter_modules(fsot.__path__)]


def python(*arguments, **options):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, **options)


def command(*arguments, **options):
    """The command as ``python -m fsot``, which needs no script on the path."""
    return python("-m", "fsot", *arguments, **options)


def test_versions_agree():
    version = importlib.metadata.version("fsot")
    assert version == fsot.__version__
    manifest = (HERE.parent / "Cargo.toml").read_text()
    assert re.search(r'\[workspace\.package\]\nversion = "(.*)"', manifest)[1] == version
    assert command("--version").stdout == f"fsot {version}\n"


def test_the_script_is_the_command():
    (entry,) = (one for one in importlib.metadata.entry_points(group="console_scripts") if one.name == "fsot")
    assert entry.value == "fsot.__main__:command"
    script = Path(sysconfig.get_path("scripts")) / "fsot"
    if not script.exists():
        pytest.skip("not installed with its script")
    done = subprocess.run([script, "--version"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"fsot {fsot.__version__}\n")


def test_an_import_is_light():
    code = f"import sys, fsot; print([name for name in {HEAVY} if name in sys.modules])"
    done = python("-c", code)
    assert done.stdout == "[]\n", done.stderr

    def seconds(code):
        """Of processor time, the least of three."""
        timed = f"import time; t = time.process_time(); {code}; print(time.process_time() - t)"
        return min(float(python("-c", timed).stdout) for _ in range(3))

    ours, numpys = seconds("import fsot"), seconds("import numpy, json, numpy.typing")
    assert ours - numpys < 0.15, (ours, numpys)


def test_all_is_what_there_is():
    assert fsot.__all__ == sorted(fsot.__all__)
    for name in fsot.__all__:
        assert getattr(fsot, name) is not None
    things = {name for name, value in vars(fsot).items() if not inspect.ismodule(value)}
    assert {name for name in things if not name.startswith("_")} <= set(fsot.__all__)


def test_help_is_a_tour():
    text = pydoc.plain(pydoc.render_doc(fsot))
    start = text[: text.index("PACKAGE CONTENTS")]
    for name in fsot.__all__:
        assert re.search(rf"\b{name}\b", start) or name.startswith("_"), f"the tour doesn't pass {name}"


@pytest.mark.parametrize("name", [name for name in fsot.__all__ if callable(getattr(fsot, name))])
def test_everything_is_documented(name):
    thing = getattr(fsot, name)
    assert inspect.getdoc(thing), name
    if not inspect.isclass(thing):
        return
    for attribute, value in vars(thing).items():
        if not attribute.startswith("_"):
            assert inspect.getdoc(value), f"{name}.{attribute}"


@pytest.mark.parametrize("name", ["fsot", *MODULES])
def test_examples_in_docstrings(name, tmp_path, monkeypatch):
    if name == "fsot.__main__":
        pytest.skip("a script")
    for heavy in ("torch", "jax"):
        if name.endswith(heavy):
            pytest.importorskip(heavy)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fsot._progress._in_notebook", lambda: False)
    module = importlib.import_module(name)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    said = io.StringIO()
    for test in doctest.DocTestFinder().find(module, name):
        runner.run(test, out=said.write)
    assert not runner.failures, said.getvalue()


def test_examples_in_the_readme(tmp_path, monkeypatch, capsys):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    monkeypatch.chdir(tmp_path)
    readme = HERE / "README.md"
    names: dict[str, object] = {}
    blocks = re.findall(r"^```python(.*?)\n(.*?)^```", readme.read_text(), re.M | re.S)
    assert len(blocks) >= 5
    for kind, block in blocks:
        for heavy in re.findall(r"^import (torch|jax)", block, re.M):
            if not importlib.util.find_spec(heavy):
                break
        else:
            exec(compile(block, str(readme), "exec"), names)
    assert Path("table.npy").exists() and Path("table.png").stat().st_size > 1000


def test_sources_fit_the_page():
    long = []
    for folder in ("fsot", "src", "tests", "examples"):
        for path in (HERE / folder).rglob("*"):
            if path.suffix not in {".py", ".pyi", ".rs"}:
                continue
            lines = path.read_text().splitlines()
            if len(lines) > 400 and folder != "tests" and path.suffix != ".pyi":
                long.append(f"{path} has {len(lines)} lines")
            most = 110 if path.suffix == ".rs" else 120
            wide = (at for at, line in enumerate(lines, 1) if len(line) > most)
            long += [f"{path}:{at} is wider than {most}" for at in wide]
    assert not long, "\n".join(long)


def test_no_word_is_an_answer_too():
    done = command()
    assert done.returncode == 2
    assert "Usage: fsot" in done.stderr and "A tour:" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--help"], 0),
        (["table", "--width", "8", "--height", "8", "--frames", "1", "--sweeps", "2", "--quiet"], 0),
        (["table", "--dims", "0"], 1),
        (["inspect", "missing.npy"], 1),
        (["table", "--spp", "few"], 2),
        (["nonsense"], 2),
    ],
)
def test_exit_codes(arguments, code, tmp_path):
    done = command(*arguments, cwd=tmp_path)
    assert done.returncode == code, done.stderr
    assert "Traceback" not in done.stderr
    assert (code == 0) == (not done.stderr)
    assert (tmp_path / "table.npy").exists() == (arguments[0] == "table" and code == 0)


def test_words_of_any_bytes_are_taken(tmp_path):
    name = os.fsencode(tmp_path) + b"/\xff.npy"
    try:
        Path(os.fsdecode(name)).touch()
    except OSError:
        pytest.skip("no such names here")
    flags = ["--width", "8", "--height", "8", "--frames", "1", "--sweeps", "2", "--quiet", "--out"]
    done = subprocess.run([sys.executable, "-m", "fsot", "table", *flags, name], capture_output=True)
    assert done.returncode == 0, done.stderr
    assert numpy.load(os.fsdecode(name)).shape == (1, 8, 8, 1, 2)


def started(*arguments, **options):
    """The command, when it is at work."""
    words = [sys.executable, "-m", "fsot", *arguments]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_run_and_keeps_it(number, tmp_path):
    # A run of an hour; the log tells that it has begun.
    arguments = ["table", "--frames", "1", "--seconds", "3600", "--log", "run.csv", "--quiet"]
    process = started(*arguments, cwd=tmp_path)
    until = time.monotonic() + 60
    log = tmp_path / "run.csv"
    while not (log.exists() and len(log.read_text().splitlines()) > 2) and time.monotonic() < until:
        time.sleep(0.05)
    process.send_signal(number)
    said, complained = process.communicate(timeout=60)
    assert process.returncode == 3, complained
    assert b"Traceback" not in complained
    table = fsot.Table.load(tmp_path / "table.npy")
    assert table.metadata["run"]["ended_early"] and table.metadata["run"]["steps"] > 0


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks into /proc")
def test_a_signal_with_nothing_to_keep_kills(tmp_path):
    fsot.table(256, 256, 64, sweeps=0, progress=False).save(tmp_path / "table.npy")
    # numpy has no threads then; those that come are the command's, at work.
    process = started("inspect", "table.npy", cwd=tmp_path, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    until = time.monotonic() + 60
    while time.monotonic() < until and process.poll() is None:
        status = Path(f"/proc/{process.pid}/status").read_text()
        if int(re.search(r"Threads:\s*(\d+)", status)[1]) > 1:
            break
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    said, complained = process.communicate(timeout=60)
    assert (process.returncode, complained) == (-signal.SIGINT, b"")


def test_a_reader_who_goes_away_is_no_failure():
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([sys.executable, "-m", "fsot", "--help"], stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


def test_the_command_makes_the_same_bits(tmp_path):
    arguments = "table --width 24 --height 16 --frames 3 --spp 2 --dims 3 --seed 5 --sweeps 6 --quiet"
    assert command(*arguments.split(), cwd=tmp_path).returncode == 0
    here = fsot.table(24, 16, 3, 2, 3, seed=5, sweeps=6, progress=False)
    there = fsot.Table.load(tmp_path / "table.npy")
    assert here == there
    assert here.metadata["configuration"] == there.metadata["configuration"]


def test_where_the_sources_hide_the_package(tmp_path):
    # As in the folder python/ of a fresh clone: the Python half is here, the compiled half is elsewhere.
    (tmp_path / "fsot").mkdir()
    for path in (HERE / "fsot").glob("*.py"):
        (tmp_path / "fsot" / path.name).write_text(path.read_text())
    done = python("-c", "import fsot", cwd=tmp_path)
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: ") and "pip install" in last
