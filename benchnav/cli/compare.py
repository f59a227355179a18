"""`benchnav compare`: what is different between two navigators, by how much, how sure."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, one_of, put, say
from benchnav.cli.reading import reading
from benchnav.errors import UsageError


class Format(StrEnum):
    """What the comparison is written in."""

    MARKDOWN = "markdown"
    CSV = "csv"
    JSON = "json"


def compare(
    told: Annotated[
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
    format: Annotated[str, typer.Option(help="markdown, csv or json.")] = Format.MARKDOWN.value,
    out: Annotated[
        Path | None,
        typer.Option(help="Write it to this file; to .png, .svg or .pdf as a figure."),
    ] = None,
    recompute: Annotated[
        bool,
        typer.Option("--recompute", help="Measure the stored episodes again, with every metric."),
    ] = False,
) -> None:
    """Say in words what is different between navigators A and B, by how much, and how sure.

    Paired worlds, 95 % intervals, all that is said as one family of tests.
    """
    from benchnav.cli import board
    from benchnav.leaderboard.words import render_duel
    from benchnav.viewer.picture import is_picture, save

    if len(told) < 3:
        raise UsageError(
            f"compare must be told a run and two navigators: RUN… A B. Got {' '.join(told)!r}."
        )
    *runs, first, second = told
    wanted = one_of(Format, "--format", format).value
    pair = first, second
    with reading([Path(run) for run in runs]) as folders:
        found, metrics = board.comparison(folders, pair, metric or None, scenario or (), recompute)
    text = render_duel(found, metrics, wanted)
    if is_picture(out):
        from benchnav.viewer.forest import draw_duel

        save(draw_duel(found, metrics), out)
        say(f"{out} is drawn")
        put(text.rstrip("\n"))
    else:
        deliver(text, out)
