"""A bar for whoever waits."""

from __future__ import annotations

import contextlib
import sys
import warnings
from collections.abc import Callable, Iterator

from ._fsot import Step


@contextlib.contextmanager
def bar(shown: bool) -> Iterator[Callable[[Step], None] | None]:
    """What is to be told of a run's progress; nothing where nobody looks."""
    if not shown or not (_in_notebook() or (sys.stderr is not None and sys.stderr.isatty())):
        yield None
        return
    with warnings.catch_warnings():
        # A notebook without widgets gets a bar of text, which is good enough.
        warnings.simplefilter("ignore")
        from tqdm.auto import tqdm

        line = tqdm(unit=" steps", leave=False, dynamic_ncols=True)

    def show(step: Step) -> None:
        line.total = step.steps
        line.update(step.step - line.n)

    try:
        yield show
    finally:
        line.close()


def _in_notebook() -> bool:
    """Whether a kernel runs this process, not merely that its module is there."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return hasattr(shell, "kernel")
