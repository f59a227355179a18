"""`benchnav report`: runs as a folder of pages."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.cli.tables.opened_runs import opened_runs


def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders or packs.")],
    out: Annotated[
        Path, typer.Option(help="Write it to this folder; an earlier report there is replaced.")
    ],
    metric: Annotated[
        list[str] | None,
        typer.Option(
            help="Show this metric; 'all' for every one. Repeatable. [default: some fifteen]"
        ),
    ] = None,
    replays: Annotated[
        int | None,
        typer.Option(
            min=0, help="Failed episodes that can be watched in it, at most. [default: 100]"
        ),
    ] = None,
    verify: Annotated[
        bool, typer.Option("--verify", help="Verify runs first that were not verified here.")
    ] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the first page.")] = False,
) -> None:
    """Write runs as a folder of pages that opens from disk and can be published as it is.

    It has the leaderboard, a page for each scenario and navigator, comparisons, and failures with
    replays.
    """
    from benchnav.api.records.replay import open_in_browser

    with opened_runs(runs) as (run, *others):
        index = run.report(out, runs=others, metrics=metric, replays=replays, verify=verify)
    put(str(index))
    if show and not open_in_browser(index):
        say("No browser could be opened here: open the file above in one.")
