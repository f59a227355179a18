"""`benchnav compare`: the differences between two navigators, and their significance."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, put, say
from benchnav.cli.output_format import out_format
from benchnav.cli.tables.opened_runs import opened_runs
from benchnav.errors import UsageError


def compare(
    arguments: Annotated[
        list[str],
        typer.Argument(metavar="RUN… A B", help="Run folders or packs, and two navigators."),
    ],
    metric: Annotated[
        list[str] | None,
        typer.Option(
            help="Compare by this metric; 'all' for every one. Repeatable."
            " [default: success, collided, spl, time_to_goal]"
        ),
    ] = None,
    scenario: Annotated[
        list[str] | None, typer.Option(help="In this scenario. Repeatable. [default: all]")
    ] = None,
    format: Annotated[
        str | None,
        typer.Option(help="markdown, csv or json. [default: as --out ends, or markdown]"),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Write it to this file, .md, .csv or .json; to .png, .svg or .pdf as a figure."
        ),
    ] = None,
    recompute: Annotated[
        bool,
        typer.Option("--recompute", help="Measure the stored episodes again, with every metric."),
    ] = False,
) -> None:
    """Compare navigators A and B: differences, their intervals, and their significance.

    Worlds are paired, intervals are of 95 %, and all sentences are one family of tests.
    """
    from benchnav.leaderboard.rendering.prose import FORMATS
    from benchnav.viewer.picture import SUFFIXES, is_picture

    if len(arguments) < 3:
        raise UsageError(
            "compare needs a run and two navigators: RUN… A B."
            f" Got {' '.join(arguments)!r} instead."
        )
    *runs, first, second = arguments
    wanted = out_format(FORMATS, format, out, SUFFIXES)
    with opened_runs([Path(path) for path in runs]) as (run, *others):
        found = run.compare(
            first, second, metrics=metric, scenarios=scenario or (), runs=others,
            recompute=recompute,
        )  # fmt: skip
    if is_picture(out):
        found.plot(out)
        say(f"{out} is drawn")
        put(found.text(wanted).rstrip("\n"))
    else:
        deliver(found.text(wanted), out)
