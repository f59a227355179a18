"""`benchnav merge`: one run of several that share a suite."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.text.plural import counted


def merge(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders of one suite.")],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Run folder that gets everything.")],
) -> None:
    """Merge runs that executed shares of one suite.

    Prints the merged run on stdout, and says what it still lacks. Episodes that several
    runs hold must be the same.
    """
    from benchnav.cli.tables.run_reading import warn_if_unfinished
    from benchnav.store.runs import merge as merging

    try:
        merged = merging.merge(runs, out)
    except KeyboardInterrupt as stopped:
        stopped.add_note(f"what was copied is kept. The same command continues in {out}.")
        raise
    again = f"; already there, and the same: {merged.twice}" if merged.twice else ""
    say(f"{counted(merged.copied, 'episode')} copied{again}")
    warn_if_unfinished(merged.run)
    put(str(out))
