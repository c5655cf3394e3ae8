"""What is given: names of files, plain data, masked arrays, arrays that others write to."""

import copy
import math
import pickle

import numpy
import pytest

import fsot

TABLE = fsot.Table(numpy.random.default_rng(0).random((1, 4, 4, 1, 2)))
POINTS = fsot.Points([[0.5, 0.25], [0.25, 0.75]], [0, 1])
OPTIMIZER = fsot.Optimizer(fsot.Config(4, 4))

WRITE = {
    "save": (TABLE.save, "npy"),
    "report": (TABLE.report, "html"),
    "pictures": (lambda path: TABLE.report(png=path), "png"),
    "export": (TABLE.export, "png"),
    "points": (POINTS.save, "npy"),
    "points as text": (POINTS.save, "csv"),
    "checkpoint": (OPTIMIZER.checkpoint().save, "checkpoint"),
}
READ = {
    "load": (fsot.Table.load, "npy"),
    "import": (fsot.import_table, "npy"),
    "import of a picture": (fsot.import_table, "png"),
    "picture": (lambda path: fsot.stippling(path, 8, slices=1), "png"),
    "checkpoint": (fsot.Checkpoint.load, "checkpoint"),
}
FILES = [pytest.param(*case, id=f"write {name}") for name, case in WRITE.items()]
FILES += [pytest.param(*case, id=f"read {name}") for name, case in READ.items()]


@pytest.mark.parametrize("work, ending", FILES)
def test_files_that_cannot_be_have_the_same_exceptions_everywhere(work, ending, tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere"):
        work(str(tmp_path / "nowhere" / f"x.{ending}"))
    folder = tmp_path / f"folder.{ending}"
    folder.mkdir()
    with pytest.raises(IsADirectoryError, match="folder"):
        work(folder)
    with pytest.raises(ValueError, match="NUL|null|no name of a file"):
        work(str(tmp_path / f"nul\0.{ending}"))
    assert list(tmp_path.iterdir()) == [folder] and list(folder.iterdir()) == []


def test_advice_is_in_names_of_python(tmp_path):
    numpy.save(tmp_path / "bytes.npy", numpy.zeros((4, 4), numpy.uint8))
    (tmp_path / "folder").mkdir()
    with pytest.raises(ValueError, match=r"or fsot\.import_table with") as refusal:
        fsot.Table.load(tmp_path / "bytes.npy")
    assert "::" not in str(refusal.value)
    with pytest.raises(IsADirectoryError, match="give the path of a file"):
        fsot.import_table(tmp_path / "folder")


PLAIN = {
    "nan": (math.nan, ValueError, r"\['figures'\]\[1\]\['a'\] is nan: give a finite number or None"),
    "infinite": (-math.inf, ValueError, r"\['a'\] is -inf: give"),
    "numpy's nan": (numpy.array([1, math.nan]), ValueError, r"\['a'\]\[1\] is nan: give"),
    "long": (10**400, ValueError, r"\['a'\] is a number out of range: give"),
    # It used to come back as another one.
    "longer than 64 bits": (2**70, ValueError, r"\['a'\] is a number out of range: give"),
    "half a character": ("\ud800", ValueError, r"\['a'\] has a text with half a character.*give"),
    "key of half a character": ({"\ud800": 1}, ValueError, r"\['a'\] has a text with half"),
    "key that is no text": ({1: 2}, TypeError, r"\['a'\] has the key 1; give texts"),
    "object": (object(), TypeError, r"\['a'\] is of type object; give"),
}


@pytest.mark.parametrize("value, error, words", PLAIN.values(), ids=PLAIN)
def test_plain_data_that_no_file_holds_are_refused_by_their_place(value, error, words, tmp_path):
    metadata = {"figures": [0, {"a": value}]}
    with pytest.raises(error, match="metadata" + words if words.startswith(r"\['f") else words):
        fsot.Table(TABLE, metadata).save(tmp_path / "table.npy")
    with pytest.raises(error, match="metadata"):
        fsot.Points(POINTS, metadata=metadata).save(tmp_path / "points.npy")
    assert list(tmp_path.iterdir()) == []


def test_data_that_hold_themselves_are_refused(tmp_path):
    itself = {}
    itself["again"] = itself
    with pytest.raises(ValueError, match=r"metadata\['note'\].* is nested deeper"):
        fsot.Table(TABLE, {"note": itself}).save(tmp_path / "table.npy")


def test_figures_can_be_notes(tmp_path):
    # A pixel has no low frequencies.
    for shape in ((1, 1, 1, 1, 2), (1, 4, 4, 1, 2), (2, 4, 4, 2, 3)):
        table = fsot.Table(numpy.random.default_rng(1).random(shape))
        figures = table.inspect(integrands=2, slices=64)
        table.metadata["figures"] = figures
        table.save(tmp_path / "table.npy")
        assert fsot.Table.load(tmp_path / "table.npy").metadata["figures"] == figures
    assert fsot.Table(numpy.full((1, 1, 1, 1, 2), 0.5)).inspect(integrands=2, slices=64)["power_low"] is None


def test_plain_numbers_keep_their_bits(tmp_path):
    note = {"whole": [2**64 - 1, -(2**63)], "third": 1 / 3, "small": 5e-324, "truth": True, "none": [None]}
    table = fsot.Table(TABLE, {"note": note})
    table.save(tmp_path / "table.npy")
    loaded = fsot.Table.load(tmp_path / "table.npy").metadata["note"]
    assert loaded == note and loaded["truth"] is True


def test_faults_of_configurations_name_their_key():
    data = fsot.Config(8, 8).to_dict()
    for change, words in (
        (lambda d: d["extent"].update(width="a"), r"extent\.width: .*expected usize"),
        (lambda d: d["terms"][1].update(weight=[1]), r"terms\[1\]\.weight: .*expected f64"),
        (lambda d: d["terms"][0]["classes"]["lattice"]["kernel"]["spatial"].update(gaussian={"sigma": 2}),
         r"terms\[0\]\.classes\.lattice\.kernel\.spatial\.gaussian\.sigma: unknown"),
        (lambda d: d.update(seed=math.nan), r"data\['seed'\] is nan: give"),
    ):  # fmt: skip
        changed = copy.deepcopy(data)
        change(changed)
        with pytest.raises(ValueError, match=words):
            fsot.Config.from_dict(changed)
    with pytest.raises(ValueError, match="line 1 column 1"):
        fsot.Config.from_json("{")


MASKED = numpy.ma.masked_array(numpy.full((1, 4, 4, 1, 2), 0.5), numpy.arange(32).reshape(1, 4, 4, 1, 2) == 3)
TAKE = {
    "table": lambda a: fsot.Table(a),
    "points": lambda a: fsot.Points(a.reshape(-1, 2)),
    "labels": lambda a: fsot.Points(numpy.full((32, 2), 0.5), a.reshape(-1).astype(int)),
    "metrics": lambda a: fsot.metrics.discrepancy(a),
    "metrics of a list": lambda a: fsot.metrics.discrepancy(list(a.reshape(-1, 2))),
    "kernel": lambda a: fsot.Kernel(a.reshape(4, 8)),
    "demand": lambda a: fsot.Demand(a.reshape(4, 8) > 0),
    "picture": lambda a: fsot.stippling(a.reshape(4, 8), 4, slices=1),
    "sample": lambda a: TABLE.sample(x=a.reshape(-1).astype(int)),
}


@pytest.mark.parametrize("take", TAKE.values(), ids=TAKE)
def test_what_is_masked_is_refused(take):
    with pytest.raises(TypeError, match=r"masked in part: fill them, as by array\.filled\(0\)"):
        take(MASKED)
    take(MASKED.filled(0.5))
    # A mask that hides nothing is none.
    take(numpy.ma.masked_array(MASKED.filled(0.5)))


class Hostile:
    def __init__(self, error):
        self.error = error

    def __array__(self, dtype=None, copy=None):
        raise self.error


@pytest.mark.parametrize("make", [fsot.Table, fsot.Points, fsot.metrics.discrepancy])
@pytest.mark.parametrize("error", [TypeError("no"), ValueError("no")])
def test_what_is_no_array_is_refused_alike(make, error):
    with pytest.raises(TypeError, match="no array of .*: no; give one that numpy.asarray takes"):
        make(Hostile(error))


def fresh_arrays(tmp_path):
    made = fsot.table(8, 8, sweeps=1, progress=False)
    made.save(tmp_path / "table.npy")
    points = fsot.classes([4, 4], slices=2, progress=False)
    yield from (made.array, fsot.Table.load(tmp_path / "table.npy").array)
    yield fsot.import_table(tmp_path / "table.npy").table.array
    yield from (points.array, points.labels)
    yield fsot.Table(numpy.full((1, 2, 2, 1, 2), 0.5)).array
    yield fsot.Points([[0.5, 0.5]]).array


def test_what_is_made_cannot_be_written_to(tmp_path):
    for array in fresh_arrays(tmp_path):
        with pytest.raises(ValueError):
            array.setflags(write=True)
        base = array
        while isinstance(base, numpy.ndarray):
            with pytest.raises(ValueError):
                base[...] = 0
            base = base.base


def test_arrays_of_others_are_not_copied_and_stay_theirs():
    own = numpy.full((1, 2, 2, 1, 2), 0.5, numpy.float32)
    table = fsot.Table(own)
    assert table.array.ctypes.data == own.ctypes.data and own.flags.writeable
    assert fsot.Table(table).array.ctypes.data == own.ctypes.data
    flat = own.reshape(-1, 2)
    points = fsot.Points(flat)
    assert points.array.ctypes.data == own.ctypes.data and flat.flags.writeable


def test_points_that_were_written_to_are_looked_at_again(tmp_path):
    own = numpy.full((4, 2), 0.5, numpy.float32)
    points = fsot.Points(own)
    points.save(tmp_path / "before.npy")
    before = sorted(tmp_path.iterdir())
    for value in (math.nan, 1, -0.5, math.inf):
        own[2, 1] = value
        with pytest.raises(ValueError, match="coordinate 1 of point 2 is"):
            points.save(tmp_path / "after.npy")
        with pytest.raises(ValueError, match="coordinate 1 of point 2 is"):
            points._repr_png_()
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
@pytest.mark.parametrize("one", [TABLE, POINTS])
def test_notes_of_a_copy_are_its_own(duplicate, one):
    one.metadata["note"] = {"list": [1]}
    other = duplicate(one)
    other.metadata["note"]["list"].append(2)
    assert one.metadata.pop("note") == {"list": [1]} and other == one


def test_indices_of_any_size_wrap():
    assert TABLE.sample(x=10**30).tolist() == TABLE.sample(x=10**30 % 4).tolist()
    assert TABLE.sample(y=-(10**30) - 1).tolist() == TABLE.sample(y=3).tolist()
    for wrong in ([10**30], 1.5, True, "a"):
        with pytest.raises(TypeError, match="index of dtype .*: give whole numbers"):
            TABLE.sample(x=wrong)


@pytest.mark.parametrize("number", [16.5, "16", None, [16], True, numpy.float32(16)])
def test_what_is_no_whole_number_is_said(number):
    with pytest.raises(TypeError, match="is no whole number: give one") as refusal:
        fsot.Config(number, 16)
    assert repr(number) in str(refusal.value)


@pytest.mark.parametrize(
    "families", [[1], None, {"a": 1}, {"a": [1]}, {3: []}, {"a": "b"}, [fsot.metrics.Integrand(sum, 2, 1, 1)]]
)
def test_integrands_say_what_they_want(families):
    with pytest.raises(TypeError, match="give a dictionary of lists of Integrand by the names"):
        fsot.metrics.Integrands(families)


@pytest.mark.parametrize("aspect", [-1, 0, math.nan, math.inf, 1e300, "wide", None, [1]])
def test_aspects_of_no_picture_are_refused(aspect):
    points = fsot.Points(POINTS, metadata={"aspect": aspect})
    for look in (lambda: points.aspect, points._repr_png_):
        with pytest.raises(ValueError, match=r"metadata\['aspect'\] is .*: give width over height"):
            look()
    points.metadata["aspect"] = numpy.float32(2)
    assert points.aspect == 2
