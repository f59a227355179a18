"""`benchnav compare`: what is different between two navigators, by how much, how sure."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, put, say
from benchnav.cli.output_format import out_format
from benchnav.cli.tables.run_reading import reading
from benchnav.errors import UsageError


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
    """Say in words what is different between navigators A and B, by how much, and how sure.

    Paired worlds, 95 % intervals, all that is said as one family of tests.
    """
    from benchnav.cli.tables import board
    from benchnav.leaderboard.rendering.prose import FORMATS, render_duel
    from benchnav.viewer.picture import SUFFIXES, is_picture, save

    if len(told) < 3:
        raise UsageError(
            f"compare must be told a run and two navigators: RUN… A B. Got {' '.join(told)!r}."
        )
    *runs, first, second = told
    wanted = out_format(FORMATS, format, out, SUFFIXES)
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
