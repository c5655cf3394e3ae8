"""Other people's formats: the same bytes as the command's, and back, bit for bit."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import threading
import time

import numpy
import pytest

import fsot

SHAPE = (2, 6, 8, 2, 5)
FORMATS = {
    "atlas": ("mask.png", [None, 8, 16]),
    "slices": ("mask.png", [None, 16]),
    "ktx2": ("mask.ktx2", [None, 8, 16, "half", 32]),
    "exr": ("mask.exr", [None, "half", 32]),
    "exr-layers": ("mask.exr", [None, "half"]),
    "raw": ("mask.raw", [None, 8, "half"]),
    "fast": ("mask.bin", [None]),
    "c": ("mask.h", [None, 16]),
    "pbrt": ("mask.cpp", [None]),
    "csv": ("mask.csv", [None]),
    "dat": ("mask.dat", [None]),
}


@pytest.fixture(scope="module")
def table():
    return fsot.Table(numpy.random.default_rng(3).random(SHAPE, dtype=numpy.float32))


def decoded(table, bits):
    values = table.array
    if bits in (8, 16):
        return ((numpy.floor(values.astype(float) * 2**bits) + 0.5) / 2**bits).astype(numpy.float32)
    if bits == "half":
        return numpy.minimum(values.astype(numpy.float16), numpy.float16(1 - 2**-11)).astype(numpy.float32)
    return values


@pytest.mark.parametrize("format", FORMATS)
def test_files_are_those_of_the_command_and_come_back(format, table, command, tmp_path):
    name, all_bits = FORMATS[format]
    table.save(tmp_path / "table.npy")
    for bits in all_bits:
        ours, theirs = tmp_path / f"ours {bits}", tmp_path / f"theirs {bits}"
        ours.mkdir()
        theirs.mkdir()
        exported = table.export(ours / name, format, bits=bits)
        flags = [] if bits is None else ["--bits", bits]
        command("export", "table.npy", "--to", format, "--out", theirs / name, *flags, "--no-loss")
        assert {path.name: path.read_bytes() for path in ours.iterdir()} == {
            path.name: path.read_bytes() for path in theirs.iterdir()
        }
        written = {*exported.files, exported.record_path}
        extra = {ours / f"{name}.txt"} if format == "raw" else set()
        assert written | extra == set(ours.iterdir())
        assert json.loads(exported.record_path.read_text()) == exported.record
        back = fsot.import_table(ours / name)
        usual = exported.record["bits"]
        numpy.testing.assert_array_equal(
            back.table.array, decoded(table, int(usual) if usual.isdigit() else usual)
        )
        assert back.record == exported.record_path and name in str(back)
        command("import", theirs / name, "--out", tmp_path / "back.npy")
        assert fsot.Table.load(tmp_path / "back.npy") == back.table


def test_names_and_rounding_are_the_command_s(table, command, tmp_path):
    table.save(tmp_path / "table.npy")
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    pattern = "noise_{kind}_{width}_{frame}_{sample}_{dims}"
    exported = table.export(tmp_path / "a" / "x.png", "slices", rounding="diffuse", name=pattern)
    command(
        *("export", "table.npy", "--to", "slices", "--out", tmp_path / "b" / "x.png"),
        *("--rounding", "diffuse", "--name", pattern, "--no-loss"),
    )
    names = sorted(path.name for path in (tmp_path / "b").iterdir())
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == names
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert exported.record["rounding"] == "diffuse" and "noise_vec4_8_0_0_0-3.png" in names


def test_endings_say_the_format(table, tmp_path):
    for ending, format in ((".PNG", "atlas"), (".ktx2", "ktx2"), (".csv", "csv"), (".exr", "exr")):
        assert table.export(tmp_path / f"mask{ending}").record["format"] == format
    with pytest.raises(ValueError, match="give format="):
        table.export(tmp_path / "mask.tga")


@pytest.mark.parametrize(
    "settings, words",
    [
        (dict(format="jpeg"), "'jpeg' is no format: give one of atlas"),
        (dict(bits=7), "'7' is no number of bits: give one of 8, 16, half, 32"),
        (dict(bits="half"), "8 or 16"),
        (dict(rounding="up"), "'up' is no rounding: give one of floor, diffuse"),
        (dict(name="a/b"), "a/b"),
        (dict(name="{colour}"), "colour"),
        (dict(format="slices", name="same"), "same"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(settings, words, table, tmp_path):
    with pytest.raises(ValueError, match=words):
        table.export(tmp_path / "mask.png", **settings)
    assert list(tmp_path.iterdir()) == []


def test_the_system_s_refusals_are_os_errors(table, tmp_path):
    with pytest.raises(OSError):
        table.export(tmp_path / "nowhere" / "mask.png")
    with pytest.raises(FileNotFoundError):
        fsot.import_table(tmp_path / "nothing.npy")


def test_ctrl_c_ends_an_export_and_leaves_nothing(tmp_path):
    large = fsot.Table(numpy.random.default_rng(0).random((8, 512, 512, 1, 2), dtype=numpy.float32))

    def interrupt():
        time.sleep(0.15)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        large.export(tmp_path / "mask.csv")
        time.sleep(5)
    # Either it was interrupted, or all was done before.
    assert len(list(tmp_path.iterdir())) in (0, 2)


# Foreign files


@pytest.mark.parametrize("dtype", ["f2", "<f4", ">f8", "u1", ">u2"])
@pytest.mark.parametrize("order", "CF")
def test_arrays_of_any_type_and_order(dtype, order, tmp_path):
    values = numpy.random.default_rng(1).random((6, 8, 2))
    levels = {"u1": 256, ">u2": 65536}.get(dtype)
    array = (values * levels).astype(dtype) if levels else (values * 0.99).astype(dtype)
    numpy.save(tmp_path / "mask.npy", numpy.asarray(array, order=order))
    imported = fsot.import_table(tmp_path / "mask.npy")
    expected = (array.astype(float) + 0.5) / levels if levels else array.astype(float)
    numpy.testing.assert_array_equal(imported.table.array[0, :, :, 0], expected.astype(numpy.float32))
    assert imported.axes == ("y", "x", "dim") and imported.levels == levels and imported.shape == (6, 8, 2)


def test_axes_levels_and_lengths_say_what_a_file_is(tmp_path, command):
    path = tmp_path / "mask.npy"
    ten_bits = numpy.random.default_rng(1).integers(0, 1024, (2, 4, 6))
    numpy.save(path, ten_bits)
    for axes in ("dim,y,x", ["dim", "y", "x"]):
        table = fsot.import_table(path, axes=axes, levels=1024).table
        expected = ((ten_bits + 0.5) / 1024).astype(numpy.float32)
        numpy.testing.assert_array_equal(table.array[0, :, :, 0], expected.transpose(1, 2, 0))
    command("import", path, "--axes", "dim,y,x", "--levels", 1024, "--out", tmp_path / "t.npy")
    assert fsot.Table.load(tmp_path / "t.npy") == table
    bare = tmp_path / "noise.bin"
    rgba = numpy.random.default_rng(1).random((3 * 4 * 4, 4), dtype=numpy.float32)
    rgba.tofile(bare)
    table = fsot.import_table(bare, dtype=numpy.float32, channels=4, dims=2, frames=3).table
    numpy.testing.assert_array_equal(table.array.reshape(-1, 2), rgba[:, :2])


def test_sets_of_files_become_one_table(table, tmp_path):
    table.export(tmp_path / "x.png", "slices", name="m_{frame}_{sample}_{dims}", bits=16)
    first = fsot.import_table(tmp_path / "m_{frame}_{sample}_0-3.png").table
    numpy.testing.assert_array_equal(first.array, decoded(table, 16)[..., :4])


@pytest.mark.parametrize(
    "settings, error, words",
    [
        (dict(axes="y,x", frames=2), ValueError, "leave out one"),
        (dict(axes="y,z"), ValueError, "'z' is no axis"),
        (dict(axes="y,y"), ValueError, "y"),
        (dict(axes="x"), ValueError, "axes"),
        (dict(levels=0), ValueError, "levels is 0"),
        (dict(frames=0), ValueError, "frames is 0"),
        (dict(frames=-1), ValueError, "out of range"),
        (dict(frames=7), ValueError, "7"),
        (dict(levels=2**70), ValueError, "out of range"),
        (dict(dtype="U4"), ValueError, "no type of numbers"),
        (dict(dtype="nonsense"), TypeError, "nonsense"),
        (dict(levels=3), ValueError, "3"),
    ],
)
def test_what_a_file_is_not_is_refused(settings, error, words, tmp_path):
    path = tmp_path / "mask.npy"
    numpy.save(path, numpy.arange(64, dtype=numpy.uint8).reshape(8, 8))
    with pytest.raises(error, match=words):
        fsot.import_table(path, **settings)


def test_no_table_is_refused_in_the_command_s_words(tmp_path, command):
    path = tmp_path / "notes.txt"
    path.write_text("these are words\n")
    with pytest.raises(ValueError) as refusal:
        fsot.import_table(path)
    said = command("import", path, "--out", tmp_path / "t.npy", code=1).stderr
    assert said.strip() == f"error: {refusal.value}"


def test_a_foreign_file_names_the_way_in(tmp_path):
    path = tmp_path / "wide.npy"
    numpy.save(path, numpy.full((1, 2, 2, 1, 1), 0.25))
    with pytest.raises(ValueError, match="import"):
        fsot.Table.load(path)
    assert fsot.import_table(path).table.array.tolist() == numpy.full((1, 2, 2, 1, 1), 0.25).tolist()
    assert isinstance(fsot.import_table(path).record, (type(None), pathlib.Path))
