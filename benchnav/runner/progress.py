"""What a run tells on stderr: a bar on a terminal, plain lines elsewhere, or nothing."""

import sys
from time import monotonic
from typing import Any

from benchnav.plural import counted


class Progress:
    """Counts finished episodes, and says nothing."""

    def begin(self, total: int, stored: int) -> None:
        """Of ``total`` episodes, ``stored`` are there already."""

    def advance(self, episodes: int) -> None:
        """So many more are finished."""

    def end(self) -> None:
        """No more will come."""


class Bar(Progress):
    """A bar with the rate and the time that is left."""

    def begin(self, total: int, stored: int) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as RichProgress

        self._bar = RichProgress(
            TextColumn("episodes"), BarColumn(), MofNCompleteColumn(), TextColumn("elapsed"),
            TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
            console=Console(stderr=True),
        )  # fmt: skip
        self._bar.start()
        self._task: Any = self._bar.add_task("episodes", total=total, completed=stored)

    def advance(self, episodes: int) -> None:
        self._bar.advance(self._task, episodes)

    def end(self) -> None:
        self._bar.stop()


class Lines(Progress):
    """A line at every tenth of the work, and no more often than every two seconds."""

    def begin(self, total: int, stored: int) -> None:
        self._total, self._stored, self._done = total, stored, stored
        self._began = self._said = monotonic()
        self._tenth = 10 * stored // total if total else 10

    def advance(self, episodes: int) -> None:
        self._done += episodes
        now, tenth = monotonic(), 10 * self._done // self._total
        if tenth == self._tenth or (now - self._said < 2.0 and self._done < self._total):
            return
        self._tenth, self._said = tenth, now
        fresh = max(self._done - self._stored, 1)
        left = (now - self._began) / fresh * (self._total - self._done)
        text = f"{self._done} of {counted(self._total, 'episode')}"
        if self._done < self._total:
            text += f", about {_span(left)} left"
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
