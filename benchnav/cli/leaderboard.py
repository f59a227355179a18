"""`benchnav leaderboard`: the table of one or more runs."""

from contextlib import ExitStack
from enum import StrEnum
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import one_of, put, say, spans, write
from benchnav.errors import UsageError

if TYPE_CHECKING:
    from benchnav.store.run_folder import RunFolder

_SHOWN = 10  # cells that are named of those that lack episodes


class Format(StrEnum):
    """What the table is written in."""

    MARKDOWN = "markdown"
    CSV = "csv"
    LATEX = "latex"
    HTML = "html"
    JSON = "json"


class Curve(StrEnum):
    """What is shown against time."""

    SUCCESS = "success"


def leaderboard(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders or packs.")],
    format: Annotated[
        str, typer.Option(help="markdown, csv, latex, html or json.")
    ] = Format.MARKDOWN.value,
    out: Annotated[Path | None, typer.Option(help="Write it to this file.")] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(help="Show this metric; 'all' for every one. Repeatable. [default: a few]"),
    ] = None,
    recompute: Annotated[
        bool,
        typer.Option("--recompute", help="Measure the stored episodes again, with every metric."),
    ] = False,
    compare: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="A B", help="Say how much A exceeds B instead. [metric: success]"),
    ] = None,
    curve: Annotated[
        str | None, typer.Option(help="Show this against time instead: success.")
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
    from benchnav.store.unpack import opened

    wanted = one_of(Format, "--format", format).value
    with ExitStack() as stack:
        folders = [stack.enter_context(opened(run)) for run in runs]
        for folder in folders:
            _warn_if_unfinished(folder)
        if curve is not None:
            one_of(Curve, "--curve", curve)
            if compare is not None or metric or recompute:
                raise UsageError("--curve must stand without --compare, --metric and --recompute.")
            text = board.curve(folders, wanted)
        elif compare is not None:
            text = board.comparison(folders, wanted, compare, metric or ["success"], recompute)
        else:
            marked = vouched(folders, verify)
            text = board.table(folders, wanted, metric or None, recompute, marked)
    if out is None:
        put(text.rstrip("\n"))
    else:
        write(out, text)
        say(f"{out} is written")


def _warn_if_unfinished(folder: "RunFolder") -> None:
    missing = dict(folder.missing())
    if not missing:
        return
    first, stop = folder.manifest.suite["seeds"]
    total = (stop - first) * sum(not cell["reason"] for cell in folder.manifest.cells)
    stored = total - sum(map(len, missing.values()))
    advice = f": run the same suite with --out {folder.path} to finish it."
    say(f"{folder.shown} holds {stored} of {total} episodes{'.' if folder.packed else advice}")
    for key, seeds in islice(missing.items(), _SHOWN):
        say(f"  missing: {spans(seeds)} of {key}")
    if len(missing) > _SHOWN:
        say(f"  … and of {len(missing) - _SHOWN} more cells")
