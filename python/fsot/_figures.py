"""Figures of a table as one row."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from ._results import flat


def flat_figures(found: dict[str, Any]) -> dict[str, Any]:
    """One row of what ``fsot inspect --json`` says; what was not measured is None or left out."""
    frames, height, width, spp, dims = found["shape"]
    bound = found["bound"]
    row: dict[str, Any] = {
        "name": found["name"],
        "frames": frames,
        "height": height,
        "width": width,
        "spp": spp,
        "dims": dims,
        "integrands": found["integrands"],
        "seed": found["seed"],
        "bound": _number(bound["value"]),
        "bound_se": _number(bound["standard_error"]),
        "bound_ratio": _number(bound["ratio_to_white_noise"]),
        "bound_ratio_se": _number(bound["ratio_standard_error"]),
    }
    for place, group in enumerate(found["groups"]):
        prefix = "" if place == 0 else "dims_" + "_".join(map(str, group["dims"])) + "."
        row.update((prefix + name, figure) for name, figure in flat(_of_group(group)).items())
    return row


def _of_group(group: dict[str, Any]) -> Iterator[tuple[str, float | None]]:
    for kind in ("error", "bias"):
        for name, ratios in group[kind].items():
            # Of a still, a frame is the table, and nothing is filtered in time.
            same = {"spatio_temporal": "spatial", "frame": "table"}.get(name, name)
            ratios = ratios or group[kind][same]
            yield from _estimate(f"{kind}_{name}", ratios["mean"])
            for family, ratio in ratios["families"].items():
                yield from _estimate(f"{kind}_{name}.{family}", ratio)
    if (histogram := group["histogram"]) is not None:
        for name in ("spread", "emptiest", "fullest"):
            yield f"histogram_{name}", _number(histogram[name])
    for dim, marginal in zip(group["dims"], group["marginals"]):
        mean = sum(marginal["counts"]) / len(marginal["counts"])
        yield f"marginal_{dim}_emptiest", min(marginal["counts"]) / mean
        yield f"marginal_{dim}_fullest", max(marginal["counts"]) / mean
        for face in marginal["faces"]:
            yield f"marginal_{dim}_within_{face['within']:g}", _number(face["density"])
        yield f"marginal_{dim}_zeros", marginal["zeros"]
    yield "discrepancy_ratio", _number(group["squared_l2_discrepancy"])
    yield "power_low", _number(group["power_at_low_frequencies"])
    for ring, ratio in zip(("0.15_0.25", "0.25_0.35", "0.35_0.5"), group["power_along_y_over_along_x"]):
        yield f"power_y_over_x_{ring}", _number(ratio)


def _estimate(name: str, estimate: dict[str, Any]) -> Iterator[tuple[str, float | None]]:
    yield name, _number(estimate["ratio"])
    yield f"{name}_se", _number(estimate["standard_error"])


def _number(figure: float | str | None) -> float | None:
    """What is not defined is `null` in JSON, or a text: None, which can be a note of a table, as NaN can't."""
    return None if figure is None or math.isnan(float(figure)) else float(figure)
