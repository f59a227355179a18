"""Cells that only this process can run, because it registered their plugins (as notebooks do)."""

from collections.abc import Iterable
from contextlib import suppress

from benchnav.errors import UsageError
from benchnav.named_module import load_by_module
from benchnav.runner.plan.contestant import source_of
from benchnav.runner.plan.job import Job
from benchnav.source.importable import is_importable
from benchnav.source.parts import live_object


def bound_here(jobs: Iterable[Job], elsewhere: bool) -> list[Job]:
    """Return the cells that no worker process can run; ``elsewhere``: on other machines."""
    return [job for job in jobs if any(_is_bound(p, elsewhere) for p in job.places)]


def refuse_limits_here(jobs: Iterable[Job], limited: bool) -> None:
    """Raise UsageError if there is a limit and a cell runs in this process."""
    labels = dict.fromkeys(job.contestant.label for job in jobs)
    if labels and limited:
        raise UsageError(
            f"A limit cannot be enforced for {', '.join(map(repr, labels))}: the class is known"
            " only in this process, and limits hold in worker processes. Leave the limit out, or"
            " move the class into a module."
        )


def refuse_edited(jobs: Iterable[Job]) -> None:
    """Raise UsageError if this process would run code that differs from its source files."""
    evaluated = {job.contestant.label: job for job in jobs if not job.undisturbed}
    for job in evaluated.values():
        for place in job.contestant.places:
            with suppress(Exception, SystemExit):  # the construction reports the reason
                load_by_module(place)
        edited = job.contestant.edited or source_of(job.contestant).edited
        if edited:
            module = edited[0]
            raise UsageError(
                f"{module} was edited after this process imported it, so"
                f" {job.contestant.label!r} would run old code. Restart Python, or call"
                f" importlib.reload({module}) and load the suite again."
            )


def _is_bound(place: str, elsewhere: bool) -> bool:
    thing = live_object(place)
    return thing is not None and (elsewhere or not is_importable(thing))
