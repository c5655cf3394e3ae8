"""What a notebook shows of a table."""

from __future__ import annotations

import base64
import html
from typing import Any

import numpy
from numpy.typing import NDArray

from . import _fsot

# Text takes the colours of the page around it, light or dark.
_FIGURE = "margin:0;width:150px"
_IMAGE = "width:150px;height:{}px;image-rendering:{};border:1px solid #8888;box-sizing:border-box"
_WORDS = "font-size:11px;line-height:1.3;opacity:.75;margin-top:4px"


def page(array: NDArray[numpy.float32], metadata: dict[str, Any], title: str) -> str:
    """A piece of HTML without scripts, of less than 100 kB."""
    _, pictures = _fsot.glance_at_table(array)
    figures = "".join(_figure(what, png) for what, png in pictures)
    words = "".join(
        f'<div style="font-size:12px;opacity:.85">{html.escape(line)}</div>' for line in _origin(metadata)
    )
    return (
        f'<div style="font-family:sans-serif"><div><b>{html.escape(title)}</b></div>{words}'
        f'<div style="display:flex;flex-wrap:wrap;gap:10px;margin-top:8px">{figures}</div></div>'
    )


def _figure(what: str, png: bytes) -> str:
    width, height = (int.from_bytes(png[at : at + 4], "big") for at in (16, 20))
    text = html.escape(what)
    tall = min(300, max(12, round(150 * height / width)))
    style = _IMAGE.format(tall, "pixelated" if width <= 150 else "auto")
    data = base64.b64encode(png).decode("ascii")
    return (
        f'<figure style="{_FIGURE}"><img alt="{text}" style="{style}" '
        f'src="data:image/png;base64,{data}"><figcaption style="{_WORDS}">{text}</figcaption></figure>'
    )


def _origin(metadata: dict[str, Any]) -> list[str]:
    """How the table was made, as far as it is known. Metadata may have been changed by anybody."""
    run = metadata.get("run")
    if not isinstance(run, dict) or not run.get("steps"):
        return []
    parts = [f"seed {metadata.get('seed')}", f"{run.get('steps')} steps"]
    seconds = run.get("seconds")
    if isinstance(seconds, float):
        parts.append(f"{seconds:.2f} s")
    if run.get("ended_early"):
        parts.append("ended early")
    return ["made with " + ", ".join(map(str, parts))]
