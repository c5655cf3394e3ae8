"""What a notebook shows: small, soon, safe, and of the table."""

from __future__ import annotations

import base64
import html.parser
import io
import re
import time

import numpy
import pytest

import fsot

SHAPES = {
    "usual": (1, 64, 64, 1, 2),
    "of one dimension": (1, 64, 64, 1, 1),
    "of four": (1, 32, 48, 1, 4),
    "an animation": (16, 32, 32, 1, 2),
    "many samples": (1, 16, 16, 64, 2),
    "one pixel": (1, 1, 1, 1, 1),
    "one pixel of many samples": (1, 1, 1, 5000, 3),
    "a row": (1, 1, 3000, 1, 2),
    "a column": (1, 700, 1, 1, 2),
    "large": (1, 512, 512, 1, 2),
    "huge": (1, 2048, 2048, 1, 2),
    "huge of many samples": (1, 256, 256, 64, 2),
    "of all dimensions": (1, 128, 128, 1, 64),
}
# Bytes, and seconds of processor time.
SMALL = 100_000
SOON = 0.2


class Tags(html.parser.HTMLParser):
    """What is in a page, and whether it closes."""

    def __init__(self):
        super().__init__()
        self.names, self.open, self.values = set(), [], []

    def handle_starttag(self, tag, attrs):
        self.names.add(tag)
        self.values += [name for name, _ in attrs]
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def white(shape):
    return fsot.Table(numpy.random.default_rng(0).random(shape, dtype=numpy.float32))


def cost(show):
    show()
    started = time.process_time()
    shown = show()
    return time.process_time() - started, shown


@pytest.mark.parametrize("name", SHAPES)
def test_pictures_are_small_and_soon_there(name):
    table = white(SHAPES[name])
    seconds, png = cost(table._repr_png_)
    assert len(png) <= SMALL and seconds <= SOON, (len(png), seconds)
    seconds, page = cost(table._repr_html_)
    assert len(page) <= SMALL and seconds <= SOON, (len(page), seconds)
    tags = Tags()
    tags.feed(page)
    assert tags.open == [] and tags.names <= {"div", "b", "figure", "img", "figcaption"}
    assert set(tags.values) <= {"style", "alt", "src"}
    assert set(re.findall(r'src="([^,]*)', page)) == {"data:image/png;base64"}


def pictures(table):
    image = pytest.importorskip("PIL.Image")
    found = re.findall(r'alt="([^"]*)"[^>]*base64,([^"]*)"', table._repr_html_())
    return {
        what: numpy.asarray(image.open(io.BytesIO(base64.b64decode(data)))).astype(float)
        for what, data in found
    }


def one(found, words):
    return next(picture for what, picture in found.items() if words in what)


def test_numbers_are_shown_as_they_are():
    table = white((2, 24, 32, 3, 2))
    shown = one(pictures(table), "first number")
    numpy.testing.assert_array_equal(shown, numpy.round(table.array[0, :, :, 0, 0] * 255))


def test_errors_show_how_good_a_table_is():
    good, bad = fsot.table(64, 64, sweeps=20, progress=False), white((1, 64, 64, 1, 2))
    smooth = [one(pictures(table), "smoothed").std() for table in (good, bad)]
    # The README: a fifth of the squared error, seen through a scale that cuts at three deviations.
    assert smooth[0] < 0.6 * smooth[1]
    spectra = [one(pictures(table), "spectrum") for table in (good, bad)]
    low = [spectrum[29:36, 29:36].mean() for spectrum in spectra]
    assert low[0] < 0.5 * low[1]
    # White noise is grey in the middle of the scale.
    assert spectra[1].mean() == pytest.approx(127.5, abs=8)


def test_a_corner_says_that_it_is_one():
    found = pictures(white((1, 300, 400, 1, 2)))
    assert "96 × 96 pixels of 400 × 300" in next(iter(found))
    assert one(found, "first number").shape == (96, 96)
    assert not any("pixels of" in what for what in pictures(white((1, 64, 64, 1, 2))))


def test_sheets_are_pictures():
    image = pytest.importorskip("PIL.Image")
    sheet = image.open(io.BytesIO(white((1, 64, 64, 1, 2))._repr_png_()))
    assert sheet.mode == "L" and sheet.size == (5 * 268 + 12, 280)


def test_words_are_escaped():
    table = fsot.table(8, 8, sweeps=2, progress=False)
    assert "made with seed 0, " in table._repr_html_()
    table.metadata["seed"] = "<script>alert(1)</script>"
    table.metadata["run"]["steps"] = "<img src=x>"
    page = table._repr_html_()
    assert "<script" not in page and "<img src=x" not in page and "&lt;script" in page


@pytest.mark.parametrize("metadata", [{"run": None}, {"run": []}, {"run": {"steps": 3, "seconds": "NaN"}}, {"seed": 1}])
def test_odd_metadata_are_no_obstacle(metadata):
    assert "<b>1 frame, 2 x 2 pixels" in fsot.Table(numpy.zeros((1, 2, 2, 1, 1)), metadata)._repr_html_()
