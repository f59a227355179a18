"""`benchnav leaderboard`: the table of one or more runs."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, one_of, say
from benchnav.cli.reading import reading
from benchnav.errors import UsageError


class Format(StrEnum):
    """What the table is written in."""

    MARKDOWN = "markdown"
    CSV = "csv"
    LATEX = "latex"
    HTML = "html"
    JSON = "json"


def leaderboard(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders or packs.")],
    format: Annotated[
        str, typer.Option(help="markdown, csv, latex, html or json.")
    ] = Format.MARKDOWN.value,
    out: Annotated[
        Path | None, typer.Option(help="Write it to this file; a curve also to .png, .svg or .pdf.")
    ] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(help="Show this metric; 'all' for every one. Repeatable. [default: a few]"),
    ] = None,
    recompute: Annotated[
        bool,
        typer.Option("--recompute", help="Measure the stored episodes again, with every metric."),
    ] = False,
    curve: Annotated[
        str | None,
        typer.Option(
            metavar="AXIS",
            help="Show success, or one --metric, against horizon or a parameter of scenarios.",
        ),
    ] = None,
    verify: Annotated[
        bool,
        typer.Option("--verify", help="Verify the runs first that were not verified here before."),
    ] = False,
) -> None:
    """Print the table of one or more runs.

    Means, 95 % intervals, and ties shown as ties. Entries whose runs were verified on this
    machine are marked.
    """
    from benchnav.cli import board
    from benchnav.cli.vouched import vouched
    from benchnav.leaderboard.curve_table import render_curves
    from benchnav.viewer.curves import draw_curves
    from benchnav.viewer.picture import is_picture, save

    wanted = one_of(Format, "--format", format).value
    if is_picture(out) and curve is None:
        raise UsageError(f"A table is no picture: {out} must end otherwise, or --curve be given.")
    if curve is not None and len(metric or ["success"]) > 1:
        raise UsageError("A curve is of one metric. Got more than one --metric.")
    with reading(runs) as folders:
        if curve is None:
            marked = vouched(folders, verify)
            text = board.table(folders, wanted, metric or None, recompute, marked)
        else:
            points = board.curve(folders, curve, (metric or ["success"])[0], recompute)
            if is_picture(out):
                save(draw_curves(points), out)
                say(f"{out} is drawn")
                return
            text = render_curves(points, wanted)
    deliver(text, out)
