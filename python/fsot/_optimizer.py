"""Runs that show progress, can be stopped, and keep what they have reached."""

from __future__ import annotations

import warnings
from collections.abc import Callable

from . import _fsot
from ._progress import bar
from ._table import Table, made


class Interrupted(UserWarning):
    """Ctrl-C has ended a run early. What it had reached is kept.

    ``warnings.simplefilter("error", fsot.Interrupted)`` makes it an exception, for scripts that shall end.
    """


class Optimizer(_fsot.Optimizer):
    """A table on its way.

    Parameters
    ----------
    config : Config
        What is optimised.
    demand : Demand, optional
        The part of the table that counts; all by default. Other samples keep their bits.
    start : Table or array_like, optional
        Numbers ``[frame, y, x, sample, dim]`` in ``[0, 1)`` to go on from, instead of the white noise of the
        seed. A `Table` goes on with the random numbers after those of its run, unless there is a demand.
    threads : int, optional
        Threads to work on; one a core by default. The result doesn't depend on it.

    Examples
    --------
    >>> import fsot
    >>> optimizer = fsot.Optimizer(fsot.Config(16, 16))
    >>> optimizer.run(fsot.Until.sweeps(10), progress=False).ended
    'finished'
    >>> optimizer.table()
    <fsot.Table: 1 frame, 16 x 16 pixels, 1 sample of 2 dimensions>
    """

    def run(
        self,
        until: _fsot.Until | None = None,
        callback: Callable[[_fsot.Step], bool | None] | None = None,
        *,
        progress: bool = True,
    ) -> _fsot.Report:
        """Takes steps along the schedules of the configuration.

        Parameters
        ----------
        until : Until, optional
            When to end; ``Until.usual()`` by default.
        callback : callable, optional
            Called with a `Step` after each step, on this thread; ``False`` ends the run. An exception ends it
            as well, and is raised here.
        progress : bool
            Whether to show a bar, on a terminal or in a notebook.

        Returns
        -------
        Report
            What was done. After Ctrl-C it says ``"stopped"``, and a warning (`Interrupted`) says so too.
            Whatever ended the run, `points` are what it had reached, `finish` goes on with it, and
            `checkpoint` takes it along.
        """
        return self._follow(until or _fsot.Until.usual(), callback, progress)

    def finish(
        self,
        callback: Callable[[_fsot.Step], bool | None] | None = None,
        *,
        progress: bool = True,
    ) -> _fsot.Report:
        """Goes on with the run that has ended early or was resumed, to its end: the same bits as of one that
        was left alone. Parameters and result are those of `run`, and count from where that run began.

        Raises
        ------
        RuntimeError
            There is no such run: none was begun, it has come to its end, or something else has moved the
            points since.
        """
        return self._follow(None, callback, progress)

    def table(self) -> Table:
        """The table as it is now, with the metadata of the last run, if there was one.

        They say whether a run of the same configuration and work makes it again: ``run.start`` is
        ``"elsewhere"`` if anything else has moved the points.
        """
        return made(*self._table())

    def _follow(
        self,
        until: _fsot.Until | None,
        callback: Callable[[_fsot.Step], bool | None] | None,
        progress: bool,
        depth: int = 1,
    ) -> _fsot.Report:
        """``depth``: frames of this package below the caller, whose line a warning names."""
        with bar(progress) as show:
            report, error = self._run(until, callback, show)
        if isinstance(error, KeyboardInterrupt):
            warnings.warn(
                Interrupted(f"interrupted after {report.steps} steps; what they have reached is kept"),
                stacklevel=depth + 2,
            )
        elif error is not None:
            raise error
        return report
