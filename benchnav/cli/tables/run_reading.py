"""Runs that a verb reads: folders or packs, and what they lack is told."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from benchnav.cli.console import say, spans
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.store.runs.run_folder import RunFolder

_SHOWN = 10  # cells that are named of those that lack episodes


@contextmanager
def reading(runs: Sequence[Path]) -> Iterator["list[RunFolder]"]:
    """The run folders; packs are unpacked for as long as this lasts."""
    from benchnav.store.packs.unpack import opened

    with ExitStack() as stack:
        folders = [stack.enter_context(opened(run)) for run in runs]
        for folder in folders:
            warn_if_unfinished(folder)
        yield folders


def warn_if_unfinished(folder: "RunFolder") -> None:
    """Say what a run lacks."""
    from benchnav.store.runs.spans import count

    missing = dict(folder.missing())
    if not missing:
        return
    total = sum(count(seeds) for _, seeds in folder.planned())
    stored = total - sum(map(count, missing.values()))
    advice = f": run the same suite with --out {folder.path} to finish it."
    end = "." if folder.packed else advice
    say(f"{folder.shown} holds {stored} of {counted(total, 'episode')}{end}")
    for key, seeds in islice(missing.items(), _SHOWN):
        say(f"  missing: {spans(seeds)} of {key}")
    if len(missing) > _SHOWN:
        say(f"  … and of {counted(len(missing) - _SHOWN, 'more cell')}")
