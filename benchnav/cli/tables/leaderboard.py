"""`benchnav leaderboard`: the table of one or more runs."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, put, say
from benchnav.cli.output_format import out_format
from benchnav.cli.tables.opened_runs import opened_runs
from benchnav.errors import UsageError

FORMATS = ("markdown", "csv", "latex", "html", "json", "terminal")


def leaderboard(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders or packs.")],
    format: Annotated[
        str | None,
        typer.Option(
            help="terminal, markdown, csv, latex, html or json. [default: as --out ends; terminal"
            " on a terminal, markdown when piped]"
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
        typer.Option(
            help="Show this metric; 'people' for those of people, 'all' for every one."
            " Repeatable. [default: a few]"
        ),
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
        typer.Option("--verify", help="Verify runs first that were not verified here."),
    ] = False,
) -> None:
    """Print the table of one or more runs.

    Means, 95 % intervals, and ties shown as ties. Entries whose runs were verified on this
    machine are marked.
    """
    if curve is None:
        _table(runs, format, out, metric, columns, recompute, verify)
    else:
        _curve(runs, curve, format, out, metric, columns, recompute)


def _table(
    paths: list[Path], format: str | None, out: Path | None, metric: list[str] | None,
    columns: str | None, recompute: bool, verify: bool,
) -> None:  # fmt: skip
    from benchnav.viewer.picture import is_picture

    if is_picture(out):
        raise UsageError(f"A table is no picture: {out} needs another suffix, or give --curve.")
    if format is None and out is None and sys.stdout.isatty():
        format = "terminal"
    wanted, named = out_format(FORMATS, format, out), _named(columns, metric)
    with opened_runs(paths) as (run, *others):
        found = run.leaderboard(
            metrics=metric, columns=named, runs=others, recompute=recompute, verify=verify
        )
        text = found.text(wanted)
    if wanted == "terminal" and out is None:
        put(text.rstrip("\n"), safe=True)
    else:
        deliver(text, out)


def _curve(
    paths: list[Path], axis: str, format: str | None, out: Path | None, metric: list[str] | None,
    columns: str | None, recompute: bool,
) -> None:  # fmt: skip
    from benchnav.leaderboard.rendering.curve_table import FORMATS as CURVE_FORMATS
    from benchnav.viewer.picture import SUFFIXES, is_picture

    wanted = out_format(CURVE_FORMATS, format, out, SUFFIXES)
    _refuse_for_curves(metric, columns, format if is_picture(out) else None)
    with opened_runs(paths) as (run, *others):
        found = run.curve(axis, (metric or ["success"])[0], runs=others, recompute=recompute)
    if is_picture(out):
        found.plot(out)
        say(f"{out} is drawn")
    else:
        deliver(found.text(wanted), out)


def _named(columns: str | None, metric: list[str] | None) -> list[str] | None:
    """Return the names in --columns."""
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
