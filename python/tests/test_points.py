"""Point sets: what they promise, the command's bits, foreign arrays, refusals."""

from __future__ import annotations

import json
import pickle
import signal

import numpy
import pytest
from PIL import Image

import fsot

QUIET = dict(progress=False)


def discrepancy(points):
    """Squared L2 star discrepancy (Warnock 1972) over what independent points have in the mean."""
    points = numpy.asarray(points, numpy.float64)
    n, dims = points.shape
    pairs = 1 - numpy.maximum(points[:, None], points[None])
    squared = 3.0**-dims - 2.0 ** (1 - dims) / n * (1 - points**2).prod(1).sum() + pairs.prod(2).sum() / n**2
    return squared / ((2.0**-dims - 3.0**-dims) / n)


def test_the_figure_is_one_for_independent_points():
    independent = numpy.random.default_rng(1).uniform(size=(200, 64, 2))
    assert numpy.mean([discrepancy(points) for points in independent]) == pytest.approx(1, abs=0.15)


def test_classes_and_their_union_are_uniform():
    made = fsot.classes([128, 64], slices=400, **QUIET)
    assert made.array.shape == (192, 2) and made.array.dtype == numpy.float32
    assert made.labels.dtype == numpy.uint32 and numpy.bincount(made.labels).tolist() == [128, 64]
    # A sixth of what independent points have; optimised alone they have a tenth or less.
    assert max(map(discrepancy, (made.of(0), made.of(1), made.array))) < 1 / 6


def neighbours(points):
    """Distance of each point to its nearest neighbour, in units of 1 / sqrt(n)."""
    points = numpy.asarray(points, numpy.float64)
    distances = numpy.hypot(*(points[:, None] - points[None]).T)
    numpy.fill_diagonal(distances, 2)
    return distances.min(0) * numpy.sqrt(len(points))


def test_only_sets_that_are_asked_for_are_uniform():
    alone = fsot.classes([96, 96], subsets=[[0], [1]], slices=1000, **QUIET)
    both = fsot.classes([96, 96], subsets="every", slices=1000, **QUIET)
    for made in (alone, both):
        assert max(discrepancy(made.of(0)), discrepancy(made.of(1))) < 1 / 6
    # Points of two classes that know nothing of each other may coincide: the lower quartile of distances is
    # 1.3 to 1.6 times as large where they do, over seeds.
    nearest = [numpy.percentile(neighbours(made.array), 25) for made in (alone, both)]
    assert nearest[1] > 1.2 * nearest[0], nearest


def test_pairs_of_three_classes_are_uniform_if_every_set_is():
    made = fsot.classes([64, 64, 64], subsets="every", slices=400, **QUIET)
    for pair in ([0, 1], [0, 2], [1, 2]):
        assert discrepancy(made.of(*pair)) < 1 / 4
    assert numpy.array_equal(made.of(0, 1, 2), made.array) and made.of(3).shape == made.of().shape == (0, 2)
    assert fsot.Points([[0.5]]).of(0).shape == (1, 1)
    with pytest.raises(TypeError):
        made.of([0, 1])


def test_beginnings_of_a_sequence_are_uniform():
    made = fsot.progressive(256, slices=400, **QUIET)
    assert made.labels is None and made.array.shape == (256, 2)
    for length in (16, 64, 256):
        assert discrepancy(made.array[:length]) < 1 / 3, length
    every = fsot.progressive(32, 3, lengths="every", slices=100, **QUIET)
    given = fsot.progressive(32, 3, lengths=range(1, 33), slices=100, **QUIET)
    assert every.array.shape == (32, 3) and discrepancy(given.array) < 1


def test_a_stippling_puts_its_points_where_the_picture_asks():
    # Missing to white: 3/4 of it left of the middle, and 2/3 of it above.
    light = 1 - numpy.outer([2 / 3] * 20 + [1 / 3] * 20, [0.75] * 30 + [0.25] * 30)
    count = 900
    x, y = fsot.stippling(light, count, slices=800, **QUIET).array.T
    # At most half of the row of points that lies along a border is beyond it.
    tolerance = 0.5 / numpy.sqrt(count)
    assert abs((x < 0.5).mean() - 0.75) < tolerance
    assert abs((y < 0.5).mean() - 2 / 3) < tolerance


def test_bright_is_the_light_itself():
    light = numpy.array([[1.0, 3.0]])
    x = fsot.stippling(light, 400, tone="bright", slices=500, **QUIET).array[:, 0]
    assert abs((x > 0.5).mean() - 0.75) < 0.5 / 20


def test_inks_have_their_shares():
    picture = numpy.array([[[0, 1, 1], [1, 0, 1]], [[1, 1, 0], [0, 0, 0]]], float)
    dots = fsot.color_stippling(picture, 400, slices=60, **QUIET)
    assert numpy.bincount(dots.labels).tolist() == [100] * 4
    # Cyan at the upper left, magenta at the upper right, yellow and black below.
    corners = [dots.of(ink).mean(0) for ink in range(4)]
    middles = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    numpy.testing.assert_allclose(corners, middles, atol=0.02)
    assert dots.metadata["labels"] == ["cyan", "magenta", "yellow", "black"]


def levels(shape, dtype, seed=2):
    """A smooth picture with some noise."""
    height, width = shape[:2]
    y, x = numpy.mgrid[0:height, 0:width] / max(height, width)
    smooth = 0.5 + 0.4 * numpy.sin(5 * x + 3 * y)
    smooth = smooth.reshape(smooth.shape + (1,) * (len(shape) - 2))
    noise = numpy.random.default_rng(seed).uniform(-0.1, 0.1, shape)
    return ((smooth + noise).clip(0, 1) * numpy.iinfo(dtype).max).astype(dtype)


def same_files(tmp_path, made, name):
    made.save(tmp_path / f"mine{name[name.index('.'):]}")
    mine, theirs = tmp_path / f"mine{name[name.index('.'):]}", tmp_path / name
    return mine.read_bytes() == theirs.read_bytes()


@pytest.mark.parametrize("ending", [".npy", ".csv"])
def test_classes_are_those_of_the_command(ending, command, tmp_path):
    name = f"theirs{ending}"
    common = ["--slices", 20, "--seed", 4, "--no-comparison", "--points", name]
    command("points", "two-class", "--counts", "40,30,20", "--every", *common)
    made = fsot.classes([40, 30, 20], subsets="every", slices=20, seed=4, **QUIET)
    assert same_files(tmp_path, made, name)
    command("points", "two-class", "--counts", "24,24", *common)
    assert same_files(tmp_path, fsot.classes([24, 24], slices=20, seed=4, **QUIET), name)


def test_sequences_are_those_of_the_command(command, tmp_path):
    command(
        "points", "progressive", "--count", 64, "--slices", 20, "--seeds", 2, "--integrands", 1, "--points",
        "theirs.npy",
    )
    theirs = numpy.load(tmp_path / "theirs.npy")
    made = [fsot.progressive(64, slices=20, seed=seed, **QUIET).array for seed in (0, 1)]
    assert numpy.array_equal(numpy.concatenate(made), theirs[:, :2])
    command(
        "points", "progressive", "--count", 24, "--prefixes", "every", "--slices", 20, "--integrands", 1,
        "--points", "theirs.npy",
    )
    assert same_files(tmp_path, fsot.progressive(24, lengths="every", slices=20, **QUIET), "theirs.npy")


PICTURES = {
    "grey": (levels((20, 30), "u1"), {}, []),
    "colours": (levels((20, 30, 3), "u1"), {}, []),
    "transparent": (levels((20, 30, 4), "u1"), {}, []),
    "grey and transparent": (levels((20, 30, 2), "u1"), {}, []),
    "deep": (levels((20, 30), "u2"), {}, []),
    "light": (levels((20, 30), "u1"), dict(transfer="linear"), ["--linear"]),
    "averaged": (levels((23, 31, 3), "u1"), dict(most_pixels=100), ["--most-pixels", 100]),
}


@pytest.mark.parametrize("name", PICTURES)
def test_stipplings_are_those_of_the_command(name, command, tmp_path):
    picture, settings, flags = PICTURES[name]
    Image.fromarray(picture).save(tmp_path / "picture.png")
    common = ["--picture", "picture.png", "--count", 60, "--seed", 3, *flags, "--points", "theirs.npy"]
    settings = dict(count=60, seed=3) | settings | QUIET
    command("points", "stipple", *common, "--slices", 40)
    for given in (picture, tmp_path / "picture.png", str(tmp_path / "picture.png")):
        assert same_files(tmp_path, fsot.stippling(given, slices=40, **settings), "theirs.npy")
    command("points", "color-stipple", *common, "--slices", 10)
    for given in (picture, tmp_path / "picture.png"):
        assert same_files(tmp_path, fsot.color_stippling(given, slices=10, **settings), "theirs.npy")


def test_bright_is_that_of_the_command(command, tmp_path):
    picture = levels((12, 9, 3), "u1")
    Image.fromarray(picture).save(tmp_path / "picture.png")
    command(
        "points", "stipple", "--picture", "picture.png", "--count", 50, "--bright", "--slices", 40,
        "--points", "theirs.csv",
    )
    made = fsot.stippling(picture, 50, tone="bright", slices=40, **QUIET)
    assert same_files(tmp_path, made, "theirs.csv")


@pytest.mark.parametrize(
    ("verb", "count", "slices"),
    [
        ("two-class", None, 4000),
        ("progressive", 4096, 8000),
        ("stipple", 8192, 16000),
        ("color-stipple", 24576, 1000),
    ],
)
def test_defaults_are_those_of_the_command(verb, count, slices, command):
    said = " ".join(command("points", verb, "--help").stdout.split())
    assert f"[default: {slices}]" in said and (count is None or f"[default: {count}]" in said)
    picture = numpy.zeros((2, 2))
    made = {
        "two-class": lambda **stop: fsot.classes([8, 8], **stop),
        "progressive": fsot.progressive,
        "stipple": lambda **stop: fsot.stippling(picture, **stop),
        "color-stipple": lambda **stop: fsot.color_stippling(picture, **stop),
    }[verb](callback=lambda step: False, **QUIET)
    assert made.metadata["run"]["slices_per_class"] == slices
    assert count is None or len(made) == count


def test_floats_are_light_unless_they_are_said_to_be_srgb():
    grey = levels((16, 16), "u1")
    made = dict(count=80, slices=60, **QUIET)
    encoded = grey / 255
    light = numpy.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    expected = fsot.stippling(grey, **made).array
    for given, transfer in ((light, None), (encoded, "srgb"), (encoded.astype("f4"), "srgb")):
        # Rounded elsewhere, so that the last bits differ.
        found = fsot.stippling(given, transfer=transfer, **made).array
        assert numpy.abs(found - expected).max() < 1e-3
    assert numpy.array_equal(
        fsot.stippling(grey, transfer="linear", **made).array,
        fsot.stippling((grey * numpy.float32(1 / 255)).astype("f4"), **made).array,
    )


def foreign():
    grey = levels((14, 10), "u1")
    read_only = grey.copy()
    read_only.flags.writeable = False
    wide = numpy.zeros((28, 30), "u1")
    wide[::2, ::3] = grey
    return grey, {
        "Fortran": numpy.asfortranarray(grey),
        "read-only": read_only,
        "mirrored": numpy.ascontiguousarray(grey[::-1, ::-1])[::-1, ::-1],
        "every other one": wide[::2, ::3],
        "one channel": grey[:, :, None],
        "equal channels": numpy.repeat(grey[:, :, None], 3, 2),
        "Pillow's": Image.fromarray(grey),
        "deep": grey.astype("u2") * 257,
        "bytes turned": (grey.astype("u2") * 257).astype(">u2"),
    }


@pytest.mark.parametrize("name", foreign()[1])
def test_foreign_arrays_are_the_same_picture(name):
    grey, others = foreign()
    made = dict(count=50, slices=30, **QUIET)
    expected = fsot.stippling(grey, **made).array
    found = fsot.stippling(others[name], **made).array
    # Shares of 65535 and of three channels are rounded elsewhere.
    assert numpy.abs(found - expected).max() < 1e-3


def test_truth_is_black_and_white():
    picture = numpy.array([[True, False]])
    made = fsot.stippling(picture, 30, slices=20, **QUIET)
    assert made == fsot.stippling(numpy.array([[255, 0]], "u1"), 30, slices=20, **QUIET)
    assert (made.array[:, 0] >= 0.5).all()


def test_an_even_picture_makes_uniform_points():
    for picture in (numpy.zeros((5, 5)), numpy.zeros((1, 1), "u1")):
        assert discrepancy(fsot.stippling(picture, 64, slices=400, **QUIET).array) < 1 / 4


NAN = numpy.array([[0.5, numpy.nan]])
BAD = {
    "0-d": (numpy.float32(0.5), ValueError, r"shape \[\]: give two axes"),
    "a line": (numpy.zeros(4), ValueError, "give two axes"),
    "four axes": (numpy.zeros((2, 2, 3, 1)), ValueError, "give two axes"),
    "five channels": (numpy.zeros((2, 2, 5)), ValueError, "5 channels: give 1"),
    "no channels": (numpy.zeros((2, 2, 0)), ValueError, "0 channels: give 1"),
    "empty": (numpy.zeros((0, 4)), ValueError, "height"),
    "not a number": (NAN, ValueError, "NaN"),
    "darker than all": (numpy.array([[0.0, -numpy.inf]]), ValueError, "inf"),
    "white": (numpy.full((3, 3), 255, "u1"), ValueError, "above 0|nothing"),
    "int64": (numpy.zeros((2, 2), int), TypeError, "int64: give uint8"),
    "complex": (numpy.zeros((2, 2), complex), TypeError, "complex128: give uint8"),
    "None": (None, TypeError, "give uint8"),
    "ragged": ([[0.0], [0.0, 1.0]], TypeError, "give an array or the name of a file"),
    "missing": ("no/such.png", OSError, "no/such.png"),
    "a palette": (Image.new("P", (2, 2)), ValueError, r"mode P: give picture.convert\('RGB'\)"),
    "printers' inks": (Image.new("CMYK", (2, 2)), ValueError, "mode CMYK: give"),
}


@pytest.mark.parametrize("name", BAD)
@pytest.mark.parametrize("make", [fsot.stippling, fsot.color_stippling])
def test_what_is_no_picture_is_refused(name, make):
    picture, error, sentence = BAD[name]
    with pytest.raises(error, match=sentence):
        make(picture, 20, slices=1, **QUIET)


def test_light_below_none_is_refused_where_light_counts():
    with pytest.raises(ValueError, match="-1"):
        fsot.stippling(numpy.array([[-1.0, 2.0]]), 20, tone="bright", slices=1, **QUIET)
    with pytest.raises(ValueError, match="inf"):
        fsot.stippling(numpy.array([[0.5, numpy.inf]]), 20, tone="bright", slices=1, **QUIET)
    with pytest.raises(ValueError, match="above 0|nothing"):
        fsot.stippling(numpy.zeros((3, 3)), 20, tone="bright", slices=1, **QUIET)


def test_files_that_are_no_pictures_are_refused(tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(ValueError, match="of no picture; give a PNG or EXR file"):
        fsot.stippling(tmp_path / "text.png", **QUIET)
    with pytest.raises(FileNotFoundError):
        fsot.stippling(tmp_path / "missing.exr", **QUIET)
    with pytest.raises(OSError):
        fsot.color_stippling(tmp_path, **QUIET)


DARK = numpy.zeros((2, 2))


@pytest.mark.parametrize(
    ("make", "error", "sentence"),
    [
        (lambda: fsot.classes([]), ValueError, "no points: give counts"),
        (lambda: fsot.classes([0, 0]), ValueError, "no points: give counts"),
        (lambda: fsot.classes([4, -1]), ValueError, "-1 is out of range"),
        (lambda: fsot.classes([2**31]), ValueError, "stay at or below 2147483647"),
        (lambda: fsot.classes([2**62] * 4), ValueError, "stay at or below"),
        (lambda: fsot.classes([10**40]), ValueError, "out of range"),
        (lambda: fsot.classes([2.5]), TypeError, "2.5 is no whole number"),
        (lambda: fsot.classes("ab"), TypeError, "is no whole number"),
        (lambda: fsot.classes([4], 0), ValueError, "dims"),
        (lambda: fsot.classes([4], 65), ValueError, "dim"),
        (lambda: fsot.classes([4], subsets="some"), ValueError, "'some' names no sets"),
        (lambda: fsot.classes([4], subsets=[[1]]), ValueError, "label"),
        (lambda: fsot.classes([4], subsets=[[]]), ValueError, "give"),
        (lambda: fsot.classes([4], subsets=[]), ValueError, "give"),
        (lambda: fsot.classes([4], subsets=[[2**40]]), ValueError, "is no label"),
        (lambda: fsot.classes([4], subsets=3), TypeError, "iter"),
        (lambda: fsot.classes([4], domain="ring"), ValueError, "'ring' is no domain"),
        (lambda: fsot.classes([4], domain=["torus"]), ValueError, "domain"),
        (lambda: fsot.classes([4], seed=-1), ValueError, "-1 is out of range"),
        (lambda: fsot.classes([4], slices=10**10), ValueError, "give"),
        (lambda: fsot.classes([4], slices=4, seconds=1.0), ValueError, "twice: leave out one"),
        (lambda: fsot.classes([4], seconds=float("nan")), ValueError, "seconds"),
        (lambda: fsot.classes([4], threads=0), ValueError, "threads is 0"),
        (lambda: fsot.progressive(0), ValueError, "count is 0: give at least 1"),
        (lambda: fsot.progressive(8, lengths="some"), ValueError, "'some' names no lengths"),
        (lambda: fsot.progressive(8, lengths=[]), ValueError, "give"),
        (lambda: fsot.progressive(8, lengths=[9]), ValueError, "9"),
        (lambda: fsot.progressive(8, lengths=[0]), ValueError, "0"),
        (lambda: fsot.progressive(8, lengths=[(4, -1.0)]), ValueError, "-1"),
        (lambda: fsot.stippling(DARK, 0), ValueError, "count is 0"),
        (lambda: fsot.stippling(DARK, 2**40), ValueError, "stay at or below"),
        (lambda: fsot.color_stippling(DARK, 2**40), ValueError, "stay at or below"),
        (lambda: fsot.stippling(DARK, tone="grey"), ValueError, "'grey' is no tone: write dark or bright"),
        (lambda: fsot.stippling(DARK, transfer="gamma"), ValueError, "'gamma' is no transfer"),
        (lambda: fsot.stippling(DARK, most_pixels=0), ValueError, "most_pixels is 0"),
        (lambda: fsot.stippling(DARK, limit_pixels=3), ValueError, "2 x 2 pixels, which is more than 3"),
    ],
)
def test_a_bad_argument_is_refused_in_words(make, error, sentence):
    with pytest.raises(error, match=sentence):
        make()


def test_threads_make_the_same_bits():
    made = [fsot.classes([40, 40], slices=50, threads=threads, **QUIET) for threads in (1, 2, 3)]
    assert made[0] == made[1] == made[2] != fsot.classes([40, 40], slices=50, seed=1, **QUIET)


def test_a_run_in_seconds_can_be_made_again():
    made = fsot.classes(64, seconds=0.05, **QUIET)
    again = fsot.classes([64], slices=made.metadata["run"]["slices_per_class"], **QUIET)
    assert made == again


def test_a_callback_ends_a_run_and_keeps_the_points():
    steps = []
    made = fsot.classes([32, 32], callback=lambda step: steps.append(step.step) or len(steps) < 3, **QUIET)
    assert steps == [1, 2, 3] and made.metadata["run"]["ended_early"] and made.metadata["run"]["steps"] == 3
    with pytest.raises(ZeroDivisionError):
        fsot.progressive(16, callback=lambda step: 1 / 0, **QUIET)


def test_an_interrupt_ends_a_run_and_keeps_the_points():
    def interrupt(step):
        if step.step == 2:
            signal.raise_signal(signal.SIGINT)

    with pytest.warns(fsot.Interrupted, match="interrupted after 2 steps") as warned:
        made = fsot.stippling(DARK, 32, callback=interrupt, **QUIET)
    assert made.metadata["run"]["steps"] == 2 and len(made) == 32
    assert warned[0].filename == __file__


def test_points_are_read_only_views():
    made = fsot.classes([8, 4], slices=4, **QUIET)
    for array in (made.array, made.labels):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    assert numpy.shares_memory(numpy.asarray(made, copy=False), made.array)
    assert not numpy.shares_memory(numpy.array(made), made.array)
    assert numpy.array_equal(numpy.asarray(made, dtype="f8"), made.array.astype("f8"))
    with pytest.raises(ValueError, match="copy"):
        numpy.asarray(made, dtype="f8", copy=False)
    given = numpy.zeros((3, 2), numpy.float32)
    assert numpy.shares_memory(fsot.Points(given).array, given) and given.flags.writeable


def test_pickling_keeps_all():
    made = fsot.color_stippling(levels((6, 8, 3), "u1"), 40, slices=2, **QUIET)
    back = pickle.loads(pickle.dumps(made))
    assert back == made and back.metadata == made.metadata and back.aspect == 8 / 6
    assert not back.array.flags.writeable and not back.labels.flags.writeable


def test_metadata_are_plain_and_written_beside(tmp_path):
    made = fsot.classes(numpy.array([8, 4]), 3, subsets=[(0,), (1,)], seed=numpy.int64(5), slices=4, **QUIET)
    assert made.metadata["arguments"] == {
        "counts": [8, 4], "dims": 3, "subsets": [[0], [1]], "domain": None, "seed": 5, "slices": 4,
        "seconds": None,
    }
    made.save(tmp_path / "set.csv")
    record = json.loads((tmp_path / "set.points.json").read_text())
    assert record["format"] == "fsot point set 1" and record["columns"] == ["x", "y", "z", "label"]
    assert record["points"] == 12 and made.metadata.items() <= record.items()
    table = numpy.loadtxt(tmp_path / "set.csv", delimiter=",", skiprows=1, dtype=numpy.float32)
    assert numpy.array_equal(table[:, :3], made.array) and numpy.array_equal(table[:, 3], made.labels)


def test_files_that_cannot_be_written_are_refused(tmp_path):
    made = fsot.Points([[0.5, 0.5]])
    with pytest.raises(ValueError, match="ends in .npy or .csv"):
        made.save(tmp_path / "set.txt")
    with pytest.raises(FileNotFoundError, match="cannot write"):
        made.save(tmp_path / "no" / "set.npy")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "error", "sentence"),
    [
        (([0.5, 0.5],), ValueError, "give two axes"),
        ((numpy.zeros((3, 0)),), ValueError, "give two axes"),
        (([[0.0, 1.0]],), ValueError, "coordinate 1 of point 0 is 1.0"),
        (([[0.0, numpy.nan]],), ValueError, "is nan: give numbers"),
        (([["a"]],), TypeError, "give real numbers"),
        (([[0.5], [0.5, 0.5]],), TypeError, "numpy.asarray takes"),
        (([[0.5]], [1, 2]), ValueError, "one for each of the 1 points"),
        (([[0.5]], [-1]), ValueError, "labels from -1"),
        (([[0.5]], [0.5]), ValueError, "no whole numbers"),
        (([[0.5]], [numpy.nan]), ValueError, "no whole numbers"),
        (([[0.5]], [2**40]), ValueError, r"0 to 2\*\*32"),
    ],
)
def test_what_is_no_set_of_points_is_refused(arguments, error, sentence):
    with pytest.raises(error, match=sentence):
        fsot.Points(*arguments)


def drawing(points):
    from io import BytesIO

    return numpy.asarray(Image.open(BytesIO(points._repr_png_())).convert("RGB"))


def test_drawings_show_the_points():
    lower_right = fsot.Points([[0.75, 0.75]])
    dark = numpy.argwhere(drawing(lower_right).sum(2) < 200)
    y, x = dark.mean(0) / drawing(lower_right).shape[:2]
    assert abs(x - 0.75) < 0.02 and abs(y - 0.75) < 0.02
    wide = fsot.stippling(numpy.zeros((10, 40)), 30, slices=2, **QUIET)
    height, width = drawing(wide).shape[:2]
    assert width > 3 * height
    # Three panels of classes: the first has one ink, the last has both.
    image = drawing(fsot.classes([30, 30], slices=20, **QUIET)).astype(int)
    red = (image[..., 0] - image[..., 2] > 100).any(0)
    blue = (image[..., 2] - image[..., 0] > 100).any(0)
    panels = [slice(20, 320), slice(340, 640), slice(660, 960)]
    assert [(red[panel].any(), blue[panel].any()) for panel in panels] == [
        (True, False), (False, True), (True, True),
    ]
    for dims in (1, 3):
        assert drawing(fsot.classes([5, 5], dims, slices=2, **QUIET)).size > 0
    assert drawing(fsot.Points(numpy.zeros((0, 2)))).size > 0


def test_words_for_people():
    assert repr(fsot.Points([[0.5]])) == "<fsot.Points: 1 point of 1 dimension>"
    made = fsot.classes([2, 1], slices=1, **QUIET)
    assert repr(made) == "<fsot.Points: 3 points of 2 dimensions, 2 labels>"
