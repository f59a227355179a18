"""What a run tells on stderr: a bar on a terminal, plain lines elsewhere, or nothing."""

import sys
from collections.abc import Callable, Hashable, Iterable
from time import monotonic
from typing import Any

from benchnav.runner.plan.estimate import Estimate, Load
from benchnav.text.plural import counted

UNKNOWN = "estimating the time left"


class Progress:
    """Counts finished episodes, and says nothing."""

    def begin(self, total: int, stored: int) -> None:
        """Of ``total`` episodes, ``stored`` are there already."""

    def expect(self, loads: Iterable[Load]) -> None:
        """These tasks will be run; unless told, the time left follows from the episodes alone."""

    def start(self, worker: Hashable, load: Load) -> None:
        """A worker begins a task."""

    def finish(self, worker: Hashable) -> None:
        """Its task is done."""

    def drop(self, worker: Hashable) -> None:
        """The worker is gone, and its task is to be run again."""

    def advance(self, episodes: int) -> None:
        """So many more episodes are finished."""

    def end(self) -> None:
        """No more will come."""


class _Shown(Progress):
    """Counts, and estimates the time that is left."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._estimate = Estimate(clock)

    def begin(self, total: int, stored: int) -> None:
        self._total, self._stored, self._done = total, stored, stored
        self._began, self._by_load = self._clock(), False

    def expect(self, loads: Iterable[Load]) -> None:
        self._by_load = True
        for load in loads:
            self._estimate.expect(load)

    def start(self, worker: Hashable, load: Load) -> None:
        self._estimate.start(worker, load)

    def finish(self, worker: Hashable) -> None:
        self._estimate.finish(worker)

    def drop(self, worker: Hashable) -> None:
        self._estimate.drop(worker)

    def advance(self, episodes: int) -> None:
        self._done += episodes

    def left(self) -> str:
        """``about 40 s left``, or that this is not known yet."""
        if self._by_load:
            seconds = self._estimate.left()
        else:
            fresh = self._done - self._stored
            elapsed = self._clock() - self._began
            seconds = elapsed / fresh * (self._total - self._done) if fresh else None
        return UNKNOWN if seconds is None else f"about {_span(seconds)} left"


class Bar(_Shown):
    """A bar with the time that has passed and that is left."""

    def begin(self, total: int, stored: int) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            ProgressColumn,
            TextColumn,
            TimeElapsedColumn,
        )
        from rich.progress import Progress as RichProgress
        from rich.text import Text

        super().begin(total, stored)
        left = self.left

        class Left(ProgressColumn):
            """The time that is left."""

            max_refresh = 1.0

            def render(self, task: Any) -> Text:
                return Text("" if task.finished else left())

        self._bar = RichProgress(
            TextColumn("episodes"), BarColumn(), MofNCompleteColumn(), TextColumn("elapsed"),
            TimeElapsedColumn(), Left(), console=Console(stderr=True),
        )  # fmt: skip
        self._bar.start()
        self._task: Any = self._bar.add_task("episodes", total=total, completed=stored)

    def advance(self, episodes: int) -> None:
        super().advance(episodes)
        self._bar.advance(self._task, episodes)

    def end(self) -> None:
        self._bar.stop()


class Lines(_Shown):
    """A line at every tenth of the work, and no more often than every two seconds."""

    def begin(self, total: int, stored: int) -> None:
        super().begin(total, stored)
        self._said = self._began
        self._tenth = 10 * stored // total if total else 10

    def advance(self, episodes: int) -> None:
        super().advance(episodes)
        now, tenth = self._clock(), 10 * self._done // self._total
        if tenth == self._tenth or (now - self._said < 2.0 and self._done < self._total):
            return
        self._tenth, self._said = tenth, now
        text = f"{self._done} of {counted(self._total, 'episode')}"
        if self._done < self._total:
            text += f", {self.left()}"
        sys.stderr.write(text + "\n")
        sys.stderr.flush()


def progress(quiet: bool) -> Progress:
    """The kind that fits where stderr goes."""
    if quiet:
        return Progress()
    return Bar() if sys.stderr.isatty() else Lines()


def _span(seconds: float) -> str:
    whole = round(seconds)
    if whole < 90:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole / 3600:.1f} h"
