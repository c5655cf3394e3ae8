"""Tables: reading them, their figures and pages by the code of the command, their metadata."""

from __future__ import annotations

import json
import math
import pickle
import re

import numpy
import pytest

import fsot
from fsot import metrics


def white(*shape, seed=0):
    return fsot.Table(numpy.random.default_rng(seed).random(shape, dtype=numpy.float32))


@pytest.fixture(scope="module")
def table():
    return fsot.table(16, 12, 3, 2, 4, sweeps=3, progress=False)


# Reading


def test_samples_wrap_in_all_four_indices(table):
    at = table.sample(frame=-1, y=12 + 5, x=-16 * 7 + 3, sample=5)
    assert at.tolist() == table.array[2, 5, 3, 1].tolist()
    assert table.sample().tolist() == table.array[0, 0, 0, 0].tolist()
    many = table.sample(frame=numpy.arange(6)[:, None], x=numpy.arange(32), sample=[1])
    assert many.shape == (6, 32, 4)
    assert (many[4, 20] == table.array[1, 0, 4, 1]).all()
    for wrong in (0.5, "a", None, [[0], [1, 2]], True):
        with pytest.raises((TypeError, ValueError)):
            table.sample(x=wrong)


def test_displacements_are_those_of_the_r2_sequence(table):
    square = white(1, 64, 64, 1, 1)
    for use in range(40):
        dy, dx = square.displacement(use)
        assert dx == int(64 * math.fmod(0.7548776662466927 * use, 1))
        assert dy == int(64 * math.fmod(0.5698402909980532 * use, 1))
    assert square.displacement(1) == (36, 48)
    for wrong in (-1, 2**64):
        with pytest.raises(ValueError, match="out of range"):
            square.displacement(wrong)


def test_a_tile_is_what_a_renderer_reads(table):
    for use in (0, 1, 5):
        dy, dx = table.displacement(use)
        tile = table.tile(40, 30, frame=7, use=use)
        assert tile.shape == (30, 40, 2, 4) and tile.dtype == numpy.float32
        for y, x in ((0, 0), (29, 39), (13, 17)):
            assert (tile[y, x] == table.array[7 % 3, (y + dy) % 12, (x + dx) % 16]).all()
    assert (table.tile(16, 12) == table.array[0]).all()
    for wrong in (0, -3):
        with pytest.raises(ValueError, match="whole number from 1 on"):
            table.tile(wrong, 4)
    with pytest.raises(TypeError):
        table.tile(4.0, 4)


def test_vectors_are_unit_vectors_that_stay_uniform():
    table = white(1, 64, 64, 1, 3)
    for mapping, components in (("disc", 2), ("sphere", 3), ("cosine-hemisphere", 3)):
        vectors = table.mapped(mapping, (2, 0))
        assert vectors.shape == (1, 64, 64, 1, components)
        length = numpy.linalg.norm(vectors.astype(float), axis=-1)
        assert (length <= 1 + 1e-6).all()
        # 4096 vectors: means are within five standard errors of at most 1/64.
        expected = [0, 0, 2 / 3] if mapping == "cosine-hemisphere" else [0] * components
        assert numpy.abs(vectors.mean(axis=(0, 1, 2, 3)) - expected).max() < 5 / 64
        if components == 3:
            numpy.testing.assert_allclose(length, 1, atol=1e-6)
    u, v = table.array[0, 5, 7, 0, [2, 0]].astype(float)
    radius = math.sqrt(1 - (1 - 2 * u) ** 2)
    expected = [radius * math.cos(2 * math.pi * v), radius * math.sin(2 * math.pi * v), 1 - 2 * u]
    numpy.testing.assert_allclose(table.mapped("sphere", (2, 0))[0, 5, 7, 0], expected, atol=1e-6)
    with pytest.raises(ValueError, match="write disc, sphere or cosine-hemisphere"):
        table.mapped("cube")
    for dims in ((0, 0), (0, 3), (0, -1)):
        with pytest.raises(ValueError):
            table.mapped("disc", dims)


WRONG = {
    "four axes": (numpy.zeros((2, 2, 1, 2)), ValueError, "five axes"),
    "no axes": (numpy.float32(0.5), ValueError, "five axes"),
    "an empty one": (numpy.zeros((1, 0, 2, 1, 2)), ValueError, "height"),
    "one": (numpy.ones((1, 1, 1, 1, 1)), ValueError, "1"),
    "what rounds to one": (numpy.full((1, 1, 1, 1, 1), 1 - 1e-12), ValueError, "1"),
    "NaN": (numpy.full((1, 1, 1, 1, 1), numpy.nan), ValueError, "NaN"),
    "complex": (numpy.zeros((1, 1, 1, 1, 1), complex), TypeError, "complex"),
    "objects": (numpy.zeros((1, 1, 1, 1, 1), object), TypeError, "object"),
    "texts": (numpy.full((1, 1, 1, 1, 1), "0.5"), TypeError, "real numbers"),
    "too many dimensions": (numpy.zeros((1, 1, 1, 1, 65)), ValueError, "64"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_table_is_refused(name):
    array, error, words = WRONG[name]
    with pytest.raises(error, match=words):
        fsot.Table(array)


def test_arrays_of_every_kind_become_the_same_table(table):
    array = table.array
    for same in (
        array.astype(">f4"),
        array.astype(numpy.float64),
        numpy.asfortranarray(array),
        array[:, ::-1].copy()[:, ::-1],
        array.tolist(),
        table,
    ):
        assert fsot.Table(same) == table
    assert fsot.Table(array).array.__array_interface__["data"] == array.__array_interface__["data"]
    assert numpy.asarray(table, dtype=numpy.float64).dtype == numpy.float64


# Figures and pages


@pytest.mark.parametrize("shape", [(1, 8, 8, 1, 1), (1, 12, 8, 2, 2), (2, 8, 8, 1, 3), (1, 1, 1, 1, 2)])
def test_figures_are_those_of_the_command(shape, command, tmp_path):
    table = white(*shape)
    table.save(tmp_path / "white.npy")
    said = command("inspect", "white.npy", "--integrands", 16, "--bound-slices", 256, "--seed", 5, "--json")
    said = json.loads(said.stdout)
    settings = dict(integrands=16, slices=256, seed=5, name="white.npy")
    assert table.inspect(**settings, nested=True) == said
    row = table.inspect(**settings)
    first = said["groups"][0]
    assert row["error_spatial"] == first["error"]["spatial"]["mean"]["ratio"]
    assert row["bound_ratio"] == said["bound"]["ratio_to_white_noise"]
    assert [row[name] for name in ("frames", "height", "width", "spp", "dims")] == list(shape)
    # Also of what is not defined there is no NaN, which no file holds.
    assert all(figure is None or isinstance(figure, (int, float, str)) for figure in row.values())
    assert json.dumps(row, allow_nan=False)


def test_figures_of_a_run_are_those_of_the_command(command, tmp_path):
    command("table", "--width", 16, "--height", 16, "--frames", 4, "--sweeps", 2, "--quiet")
    said = json.loads(command("inspect", "table.npy", "--integrands", 8, "--json").stdout)
    table = fsot.Table.load(tmp_path / "table.npy")
    assert table.inspect(integrands=8, name="table.npy", nested=True) == said
    assert said["metadata"]["says_of_which_values"]


def test_the_filter_is_the_command_s(command, tmp_path):
    table = white(3, 8, 8, 1, 2)
    table.save(tmp_path / "white.npy")
    flags = ["--sigma", 1.3, "--temporal", "ema:0.2", "--integrands", 4]
    said = command("inspect", "white.npy", *flags, "--json")
    kernel = fsot.Kernel.gaussian(1.3, temporal="ema:0.2")
    found = table.inspect(kernel=kernel, integrands=4, name="white.npy", nested=True)
    assert found == json.loads(said.stdout)


def test_inspection_and_metrics_agree(table):
    row = table.inspect(integrands=8, slices=512)
    dims = [0, 1]
    integrands = metrics.Integrands.random(2, 8)
    measured = {
        **metrics.filtered_error(table, dims=dims, integrands=integrands).to_dict(),
        **metrics.bias(table, dims=dims, integrands=integrands).to_dict(),
        **metrics.bound(table, slices=512).to_dict(),
        **metrics.spectra(table, dims=dims, integrands=integrands).to_dict(),
        "discrepancy_ratio": metrics.discrepancy(table, dims=dims).ratio,
    }
    for name, figure in measured.items():
        assert row[name] == pytest.approx(figure, rel=1e-12, nan_ok=True), name
    second = metrics.filtered_error(table, dims=[2, 3], integrands=integrands).spatial.mean
    assert row["dims_2_3.error_spatial"] == second
    assert "dims_0_1_2_3.bias_table" in row


def test_figures_make_a_row(table):
    pandas = pytest.importorskip("pandas")
    still = white(1, 1, 1, 1, 2)
    frame = pandas.DataFrame([table.inspect(integrands=2, slices=64), still.inspect(integrands=2, slices=64)])
    assert len(frame) == 2 and frame["error_spatial"].dtype == float
    # A pixel has no low frequencies.
    assert math.isnan(frame["power_low"][1]) and not math.isnan(frame["power_low"][0])


def test_inspection_refuses_in_words(table):
    for wrong in (dict(integrands=0), dict(slices=0), dict(integrands=-1), dict(seed=2**64), dict(threads=0)):
        with pytest.raises(ValueError):
            table.inspect(**wrong)


def without_commands(page):
    return re.sub(r"<pre><code>fsot .*?</code></pre>|<footer>.*?</footer>", "", page, flags=re.S)


def test_a_page_is_that_of_the_command(command, tmp_path):
    command("table", "--width", 16, "--height", 16, "--frames", 2, "--sweeps", 2, "--quiet")
    files = ["--png", "theirs.png", "--out", "theirs.html"]
    command("report", "table.npy", *files, "--integrands", 8, "--quiet")
    table = fsot.Table.load(tmp_path / "table.npy")
    table.report(tmp_path / "ours.html", png=tmp_path / "ours.png", label="table.npy", integrands=8)
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
    ours, theirs = ((tmp_path / f"{name}.html").read_text() for name in ("ours", "theirs"))
    assert "fsot report table.npy" in theirs and "fsot report table.npy" not in ours
    # The command of the origin stands below a sentence.
    ours, theirs = without_commands(ours), without_commands(theirs)
    difference = [(a, b) for a, b in zip(ours.split("<"), theirs.split("<")) if a != b]
    assert len(ours) == pytest.approx(len(theirs), abs=200) and len(difference) < 40, difference[:3]


def test_several_tables_stand_side_by_side(table, tmp_path):
    path = tmp_path / "page.html"
    table.report(path, label="<b>ours</b>", others={"theirs & more": white(1, 8, 8, 1, 2)}, integrands=4)
    page = path.read_text()
    assert "&lt;b&gt;ours" in page and "theirs &amp; more" in page and "<b>ours" not in page


def test_pages_are_written_whole_or_not_at_all(table, tmp_path):
    with pytest.raises(ValueError, match="nothing to write"):
        table.report()
    with pytest.raises(ValueError, match="two tables are called"):
        table.report(tmp_path / "page.html", others={"table": table})
    with pytest.raises(ValueError, match="named twice"):
        table.report(tmp_path / "page.html", png=tmp_path / "." / "page.html")
    with pytest.raises(OSError, match="choose another path"):
        table.report(tmp_path / "no folder" / "page.html")
    with pytest.raises(OSError):
        table.report(tmp_path / "page.html", png=tmp_path)
    with pytest.raises(ValueError):
        table.report(tmp_path / "page.html", integrands=0)
    assert list(tmp_path.iterdir()) == []


# Metadata


def test_notes_are_kept(tmp_path):
    path = tmp_path / "table.npy"
    table = fsot.table(8, 8, sweeps=2, progress=False)
    table.metadata["scene"] = {"name": "kitchen", "spp": [1, 2.5, None], "mean": numpy.float32(0.5)}
    table.metadata["seeds"] = 2**64 - 1
    table.save(path)
    again = fsot.Table.load(path)
    scene = {"name": "kitchen", "spp": [1, 2.5, None], "mean": 0.5}
    assert again == table and again.metadata["scene"] == scene
    assert again.metadata["seeds"] == 2**64 - 1
    again.save(path)
    assert fsot.Table.load(path).metadata == again.metadata
    assert json.loads(path.with_suffix(".json").read_text()) == again.metadata


def test_a_table_may_have_nothing_but_notes(tmp_path):
    path = tmp_path / "table.npy"
    table = white(1, 4, 4, 1, 2)
    table.metadata["from"] = "somewhere else"
    table.save(path)
    again = fsot.Table.load(path)
    assert again.metadata["from"] == "somewhere else" and again.metadata["configuration"] is None
    assert again.metadata["shape"] == [1, 4, 4, 1, 2]


def test_what_would_be_lost_is_refused(tmp_path):
    path = tmp_path / "table.npy"
    table = fsot.table(8, 8, sweeps=2, progress=False)
    table.metadata["run"]["note"] = "mine"
    with pytest.raises(ValueError, match=r'metadata\["run"\]\["note"\].*at the top'):
        table.save(path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "change, error, words",
    [
        (dict(seed="seven"), ValueError, "seed|u64"),
        (dict(seed=-1), ValueError, "-1"),
        (dict(shape=[1, 4, 8, 1, 2]), ValueError, "shape|table"),
        (dict(run=None), ValueError, "null"),
        (dict(dtype="<f8"), ValueError, "dtype"),
        (dict(note=math.nan), ValueError, "is nan: give"),
        (dict(note=object()), TypeError, "plain data"),
        (dict(note={1, 2}), TypeError, "plain data"),
    ],
)
def test_metadata_that_are_none_are_refused(change, error, words, tmp_path):
    table = fsot.table(8, 8, sweeps=2, progress=False)
    table.metadata.update(change)
    with pytest.raises(error, match=words):
        table.save(tmp_path / "table.npy")
    assert list(tmp_path.iterdir()) == []


def test_metadata_of_other_values_are_refused(tmp_path):
    path = tmp_path / "table.npy"
    made = fsot.table(8, 8, sweeps=2, progress=False)
    other = fsot.Table(made.array * numpy.float32(0.5), made.metadata)
    with pytest.raises(ValueError, match="table.json"):
        other.save(path)
    assert list(tmp_path.iterdir()) == []
    figures = other.inspect(integrands=2, slices=16, nested=True)
    assert "of_another_table" in figures["metadata"]
    # Who knows better says so.
    del other.metadata["sha256"]
    other.save(path)
    assert fsot.Table.load(path) == other


def test_an_array_that_its_owner_changed_is_noticed(tmp_path):
    array = numpy.full((1, 2, 2, 1, 1), 0.5, numpy.float32)
    table = fsot.Table(array)
    with pytest.raises(ValueError, match="read-only"):
        table.array[0] = 0
    array[0, 0, 0] = 2
    for use in (lambda: table.save(tmp_path / "t.npy"), lambda: table.inspect(), table._repr_png_):
        with pytest.raises(ValueError):
            use()
    assert list(tmp_path.iterdir()) == []


def test_foreign_metadata_are_refused_in_the_library_s_words(tmp_path, command):
    path, beside = tmp_path / "table.npy", tmp_path / "table.json"
    first = fsot.table(8, 8, sweeps=2, progress=False)
    first.save(path)
    other = white(1, 8, 8, 1, 2)
    with pytest.warns(UserWarning, match="is not of this table: delete it"):
        other.save(path)
    with pytest.raises(ValueError) as refusal:
        fsot.Table.load(path)
    assert "table.json" in str(refusal.value)
    said = json.loads(command("inspect", "table.npy", "--integrands", 2, "--json").stdout)
    assert said["metadata"]["of_another_table"] in str(refusal.value)
    assert fsot.Table.load(path, metadata=False) == other
    beside.write_text(beside.read_text()[:-20])
    with pytest.raises(ValueError, match="table.json.*line"):
        fsot.Table.load(path)
    beside.unlink()
    assert fsot.Table.load(path).metadata == {}


def test_tables_travel():
    table = fsot.table(8, 8, sweeps=2, progress=False)
    again = pickle.loads(pickle.dumps(table))
    assert again == table and again.metadata == table.metadata
    assert not again.array.flags.writeable
    again.metadata["note"] = 1
    assert "note" not in table.metadata
