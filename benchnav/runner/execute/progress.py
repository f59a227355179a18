"""The progress of long work on stderr: a bar on a terminal, plain lines elsewhere, or nothing."""

import sys
from collections.abc import Callable, Hashable, Iterable
from time import monotonic, time
from typing import Any

from benchnav.kernels import compiled_since
from benchnav.runner.plan.estimate import Estimate, Load
from benchnav.text.plural import counted

UNKNOWN = "estimating the time left"
_AT_ONCE = 3.0  # [s] in which compiled kernels are loaded
_PATIENCE = 5.0  # [s] without a finished episode until the activity of a worker is shown
_LONGEST_PAUSE = 60.0  # [s] between two lines about activities
EPISODE = "episode"


class Progress:
    """The interface of a progress display; this base class prints nothing."""

    def begin(self, total: int, stored: int) -> None:
        """Start with ``total`` episodes, of which ``stored`` are stored already."""

    def expect(self, loads: Iterable[Load]) -> None:
        """Announce all tasks; without it, the remaining time is estimated from episodes only."""

    def start(self, worker: Hashable, load: Load) -> None:
        """Record that a worker begins a task."""

    def finish(self, worker: Hashable) -> None:
        """Record that the task of a worker is finished."""

    def drop(self, worker: Hashable) -> None:
        """Record that a worker ended early: its task will run again."""

    def advance(self, episodes: int) -> None:
        """Add newly finished ``episodes``; a negative number takes failed ones back."""

    def look(self, activity: str) -> None:
        """Receive what a worker does now, several times a second; "" if none has begun."""

    def end(self) -> None:
        """End the display."""


class _Shown(Progress):
    """Counts episodes, and estimates the remaining time."""

    def __init__(self, noun: str = EPISODE, clock: Callable[[], float] = monotonic) -> None:
        self._noun, self._clock = noun, clock
        self._estimate = Estimate(clock)
        self._activity = ""

    def begin(self, total: int, stored: int) -> None:
        self._total, self._stored, self._done = total, stored, stored
        self._began, self._by_load = self._clock(), False
        self._advanced = self._began
        self._moment = time()

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
        self._advanced = self._clock()

    def look(self, activity: str) -> None:
        self._activity = activity

    def left(self) -> str:
        """Return a text like ``about 40 s left``, or what is done before that is known."""
        if self._by_load:
            seconds = self._estimate.left()
        else:
            fresh = self._done - self._stored
            elapsed = self._clock() - self._began
            seconds = elapsed / fresh * (self._total - self._done) if fresh else None
        return self._beginning() if seconds is None else f"about {_span(seconds)} left"

    def _beginning(self) -> str:
        if self._activity or self._clock() - self._began < _AT_ONCE:
            return UNKNOWN
        compiled = compiled_since(self._moment)
        return f"compiling kernels, once per version: {compiled} so far" if compiled else UNKNOWN


class Bar(_Shown):
    """A bar with the elapsed and the remaining time."""

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
        left, slow_activity = self.left, self._slow_activity

        class BarAndActivity(RichProgress):
            """The bar, and below it what a worker does."""

            def get_renderables(self) -> Iterable[Any]:
                yield from super().get_renderables()
                if text := slow_activity():
                    yield Text(text, no_wrap=True, overflow="ellipsis")

        class Left(ProgressColumn):
            """The column of the remaining time."""

            max_refresh = 1.0

            def render(self, task: Any) -> Text:
                return Text("" if task.finished else left())

        self._bar = BarAndActivity(
            TextColumn(f"{self._noun}s"), BarColumn(), MofNCompleteColumn(), TextColumn("elapsed"),
            TimeElapsedColumn(), Left(), console=Console(stderr=True),
        )  # fmt: skip
        self._bar.start()
        self._task: Any = self._bar.add_task("", total=total, completed=stored)

    def advance(self, episodes: int) -> None:
        super().advance(episodes)
        self._bar.advance(self._task, episodes)

    def end(self) -> None:
        self._activity = ""
        self._bar.stop()

    def _slow_activity(self) -> str:
        return self._activity if self._clock() - self._advanced >= _PATIENCE else ""


class Lines(_Shown):
    """Prints a line after each tenth of the episodes, at most every two seconds.

    While no episode ends, it prints what a worker does, at growing intervals.
    """

    def begin(self, total: int, stored: int) -> None:
        super().begin(total, stored)
        self._reported, self._pause = self._began, _PATIENCE
        self._tenth = 10 * stored // total if total else 10

    def advance(self, episodes: int) -> None:
        super().advance(episodes)
        self._pause = _PATIENCE
        now, tenth = self._clock(), 10 * self._done // self._total
        if tenth == self._tenth or (now - self._reported < 2.0 and self._done < self._total):
            return
        self._tenth, self._reported = tenth, now
        text = f"{self._done} of {counted(self._total, self._noun)}"
        if self._done < self._total:
            text += f", {self.left()}"
        _print(text)

    def look(self, activity: str) -> None:
        super().look(activity)
        now = self._clock()
        if now - max(self._reported, self._advanced) < self._pause:
            return
        text = activity or self._beginning()
        self._reported, self._pause = now, min(1.5 * self._pause, _LONGEST_PAUSE)
        if text != UNKNOWN:
            _print(text)


def progress(quiet: bool, noun: str = EPISODE) -> Progress:
    """Return the display for stderr: a bar on a terminal, lines elsewhere, none if ``quiet``.

    ``noun`` names the things that are counted, with a plural in s.
    """
    if quiet:
        return Progress()
    return Bar(noun) if sys.stderr.isatty() else Lines(noun)


def _print(line: str) -> None:
    sys.stderr.write(line + "\n")
    sys.stderr.flush()


def _span(seconds: float) -> str:
    whole = round(seconds)
    if whole < 90:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole / 3600:.1f} h"
