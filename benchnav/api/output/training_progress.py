"""The progress of a training on stderr: a bar on a terminal, plain lines elsewhere, or nothing."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from benchnav.api.output.messages import message
from benchnav.envs.trainer import TrainingReport

Report = Callable[[TrainingReport], None]
EVERY = 10.0  # [s] between lines


@contextmanager
def training_progress(quiet: bool) -> Iterator[Report]:
    """Return the function that shows a report, as it fits where stderr goes."""
    if quiet:
        yield lambda _: None
    elif sys.stderr.isatty():
        with _bar() as report:
            yield report
    else:
        yield _lines()


@contextmanager
def _bar() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    with Progress(
        TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TextColumn("elapsed"),
        TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
        console=Console(stderr=True),
    ) as bar:  # fmt: skip
        task = bar.add_task("decisions")

        def report(now: TrainingReport) -> None:
            bar.update(task, total=now.total, completed=now.decisions)
            if now.success is not None:
                bar.update(task, description=f"validation {100 * now.success:.1f} %")

        yield report


def _lines() -> Report:
    began = reported = monotonic()
    first: int | None = None

    def report(now: TrainingReport) -> None:
        nonlocal reported, first
        first = now.decisions if first is None else first
        time = monotonic()
        if time - reported < EVERY and now.success is None:
            return
        reported = time
        rate = (now.decisions - first) / max(time - began, 1e-9)
        text = f"{now.decisions:,} of {now.total:,} decisions"
        if rate > 0 and now.decisions < now.total:
            text += f", {(now.total - now.decisions) / rate / 60:.0f} min left"
        if now.success is not None:
            text += f", validation success {100 * now.success:.1f} %"
        message(text)

    return report
