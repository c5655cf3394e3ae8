"""What the losses of torch and jax share."""

from __future__ import annotations

from typing import Literal

import numpy
from numpy.typing import NDArray

from . import _fsot

Slices = _fsot.Slices | Literal["all"] | None

#: What is said of second derivatives.
ONCE = (
    "the filtered sliced loss can be differentiated once: its gradient is computed outside of {}, where "
    "nothing differentiates it; use first derivatives alone, or finite differences of the gradient"
)


def check(objective: object, slices: object, seed: object, step: object) -> None:
    """Refuses what is no question to an objective."""
    if not isinstance(objective, _fsot.Objective):
        raise TypeError(f"{objective!r} is no objective: give fsot.Objective(config)")
    if not (slices is None or isinstance(slices, _fsot.Slices)):
        if not isinstance(slices, str):
            raise TypeError(f"{slices!r} are no slices: give those of objective.draw(), 'all', or None")
        if slices != "all":
            raise ValueError(f"'{slices}' are no slices: give those of objective.draw(), 'all', or None")
    if slices is not None and not (seed is None and step is None):
        raise ValueError("slices are given, so that there is nothing to draw: leave out seed and step")


def evaluate(
    points: NDArray[numpy.floating], objective: _fsot.Objective, slices: Slices, seed: int, step: int
) -> tuple[float, NDArray[numpy.float64]]:
    """Value and gradient."""
    try:
        if isinstance(slices, str):
            return objective.cramer(points)
        return objective.value_and_gradient(points, objective.draw(seed, step) if slices is None else slices)
    except ValueError as error:
        sentence = str(error)
        if sentence.startswith("point coordinate ") and "NaN" not in sentence:
            raise ValueError(
                f"{sentence}, as by clamping to [0, fsot.BELOW_ONE]: sigmoids and remainders round to 1.0"
            ) from None
        raise
