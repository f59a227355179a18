"""`benchnav leaderboard`: the table of one or more runs."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, say
from benchnav.cli.output_format import out_format
from benchnav.cli.tables.run_reading import reading
from benchnav.errors import UsageError

FORMATS = ("markdown", "csv", "latex", "html", "json")


def leaderboard(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders or packs.")],
    format: Annotated[
        str | None,
        typer.Option(
            help="markdown, csv, latex, html or json. [default: as --out ends, or markdown]"
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Write it to this file, .md, .csv, .tex, .html or .json; a curve also to .png,"
            " .svg or .pdf."
        ),
    ] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(help="Show this metric; 'all' for every one. Repeatable. [default: a few]"),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,…",
            help="Show these columns in this order: metrics, and rank, mode, training, rehearsal,"
            " verified, middle_half.",
        ),
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
    from benchnav.cli.tables import board
    from benchnav.cli.tables.verified_labels import vouched
    from benchnav.leaderboard.rendering.curve_table import FORMATS as CURVE_FORMATS
    from benchnav.leaderboard.rendering.curve_table import render_curves
    from benchnav.viewer.curves import draw_curves
    from benchnav.viewer.picture import SUFFIXES, is_picture, save

    if curve is None:
        if is_picture(out):
            raise UsageError(
                f"A table is no picture: {out} must end otherwise, or --curve be given."
            )
        wanted, named = out_format(FORMATS, format, out), _named(columns, metric)
    else:
        wanted, named = out_format(CURVE_FORMATS, format, out, SUFFIXES), None
        _refuse_for_curves(metric, columns, format if is_picture(out) else None)
    with reading(runs) as folders:
        if curve is None:
            folders, checked = vouched(folders, verify)
            text = board.table(folders, wanted, metric or None, recompute, checked, named)
        else:
            points = board.curve(folders, curve, (metric or ["success"])[0], recompute)
            if is_picture(out):
                save(draw_curves(points), out)
                say(f"{out} is drawn")
                return
            text = render_curves(points, wanted)
    deliver(text, out)


def _named(columns: str | None, metric: list[str] | None) -> list[str] | None:
    """The names in --columns."""
    if columns is None:
        return None
    if metric:
        raise UsageError(
            "--columns and --metric both choose what is shown. Got both: name the metrics in"
            " --columns alone."
        )
    return [name for part in columns.split(",") if (name := part.strip())]


def _refuse_for_curves(
    metric: list[str] | None, columns: str | None, of_picture: str | None
) -> None:
    if columns is not None:
        raise UsageError("A curve has no columns to choose. Got --columns: name its --metric.")
    if len(metric or ["success"]) > 1:
        raise UsageError("A curve is of one metric. Got more than one --metric.")
    if of_picture is not None:
        raise UsageError(
            f"--format and --out must agree. Got --format {of_picture} and a picture in --out."
            " Leave one of them out."
        )
