"""A picture in dots: drawn by numpy, stippled, saved. ``python stipple.py [dots.png]``, some seconds."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy

import fsot


def ball(width: int = 240, height: int = 180) -> numpy.ndarray:
    """Light of a ball on a table: ``[y, x]``, linear, 1 is white."""
    y, x = numpy.mgrid[0:height, 0:width] / height
    dx, dy = (x - 0.6) / 0.32, (y - 0.45) / 0.32
    distance = numpy.hypot(dx, dy)
    toward = numpy.sqrt(numpy.clip(1 - distance**2, 0, None))
    shading = 0.05 + 0.9 * numpy.clip(0.6 * toward - 0.6 * dx - 0.5 * dy, 0, 1)
    shadow = numpy.exp(-(((x - 0.78) / 0.3) ** 2) - ((y - 0.8) / 0.07) ** 2)
    table = numpy.where(y > 0.62, 0.75 - 0.55 * shadow, 0.95 - 0.3 * y)
    picture: numpy.ndarray = numpy.where(distance < 1, shading, table)
    return picture


def main(path: str = "dots.png") -> None:
    picture = ball()
    dots = fsot.stippling(picture, 6000, slices=2000, seed=1)
    # The share of the darkness that lies left of the middle, and that of the dots.
    darkness = 1 - picture
    print(f"left of the middle: {darkness[:, :120].sum() / darkness.sum():.3f} of the darkness,")
    print(f"                    {(dots.array[:, 0] < 0.5).mean():.3f} of the dots")
    # What a notebook shows. `dots.save("dots.csv")` writes the list.
    Path(path).write_bytes(dots._repr_png_())
    print(f"{path}: {dots}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
