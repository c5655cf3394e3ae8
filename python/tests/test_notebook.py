"""The tour runs from its first cell to its last, draws what the documentation shows, and is kept without outputs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parents[1]
TOUR = HERE / "notebooks" / "tour.ipynb"
DOCS = HERE.parent / "docs"
# What a page may weigh, and seconds of processor time that a reader waits for at the most.
BYTES, SECONDS = 60_000, 60

nbformat = pytest.importorskip("nbformat")
resource = pytest.importorskip("resource")  # of Unix


def test_no_outputs_are_kept():
    for cell in nbformat.read(TOUR, 4).cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None, cell.source
        assert "Traceback" not in cell.source


def test_the_tour_runs(tmp_path, monkeypatch):
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    monkeypatch.setenv("FSOT_FIGURES", str(tmp_path))
    tour = nbformat.read(TOUR, 4)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    where = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(tour, timeout=300, kernel_name="python3", resources=where).execute()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime - before.ru_utime < SECONDS
    said = "".join(output.get("text", "") for cell in tour.cells for output in cell.get("outputs", []))
    assert re.search(r"table +one pixel 1\.00, filtered 0\.1\d", said), said
    drawn = {path.name for path in tmp_path.glob("tour_*.png")}
    assert drawn == {path.name for path in DOCS.glob("tour_*.png")}
    for path in tmp_path.glob("tour_*.png"):
        assert 2_000 < path.stat().st_size < BYTES, path.name


def test_figures_of_the_pages_are_small():
    for path in [DOCS / "python_table.png", *DOCS.glob("tour_*.png")]:
        assert path.stat().st_size < BYTES, path.name
