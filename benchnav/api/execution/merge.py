"""One run of several that executed shares of one suite."""

from collections.abc import Iterable
from os import PathLike
from pathlib import Path

from benchnav.api.output.messages import message, silent
from benchnav.api.records.run import Run, open_run
from benchnav.text.plural import counted


def merge(
    runs: Iterable[Run | str | PathLike[str]], out: str | PathLike[str], *, quiet: bool = False
) -> Run:
    """Join runs that executed shares of one suite into the run folder ``out``.

    Raises StoreError where two runs hold different episodes of the same seed.
    """
    from benchnav.store.runs import merge as store

    try:
        merged = store.merge([run.path if isinstance(run, Run) else Path(run) for run in runs], out)
    except KeyboardInterrupt as stopped:
        stopped.add_note(f"what was copied is kept. The same command continues in {out}.")
        raise
    again = f"; already there, and the same: {merged.twice}" if merged.twice else ""
    say = silent if quiet else message
    say(f"{counted(merged.copied, 'episode')} copied{again}")
    run = open_run(out)
    run.report_missing(say)
    return run
