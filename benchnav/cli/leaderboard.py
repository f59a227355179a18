"""`benchnav leaderboard`: the table of one or more runs."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import one_of, put, say, write
from benchnav.errors import StoreError

if TYPE_CHECKING:
    import pyarrow as pa

    from benchnav.leaderboard import NotApplicable
    from benchnav.metrics.metric import Metric
    from benchnav.store.run_folder import RunFolder


class Format(StrEnum):
    """What the table is written in."""

    MARKDOWN = "markdown"
    CSV = "csv"
    LATEX = "latex"
    HTML = "html"
    JSON = "json"


def leaderboard(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders.")],
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
) -> None:
    """Print the table of one or more runs.

    Means, 95 % intervals, and ties shown as ties.
    """
    import pyarrow as pa

    from benchnav.leaderboard import leaderboard as tabulate
    from benchnav.leaderboard import render
    from benchnav.leaderboard.label import require_one_navigator_per_label
    from benchnav.metrics.measure import all_metrics
    from benchnav.store.run_folder import RunFolder

    wanted = one_of(Format, "--format", format)
    metrics = {metric.name: metric for metric in all_metrics()}
    folders = [RunFolder.open(run) for run in runs]
    for folder in folders:
        _warn_if_unfinished(folder)
    tables = {str(f.path): _measured(f.path, list(metrics.values()), recompute) for f in folders}
    require_one_navigator_per_label(tables)
    missing = [gap for folder in folders for gap in _not_applicable(folder)]
    joined = pa.concat_tables(tables.values(), promote_options="default")
    if not len(joined):
        raise StoreError(f"There must be episodes to make a table of. {runs[0]} holds none.")
    board = tabulate(joined, metrics, missing)
    text = render(board, wanted.value, metric or None)
    if out is None:
        put(text.rstrip("\n"))
    else:
        write(out, text)
        say(f"{out} is written")


def _measured(run: Path, metrics: "list[Metric]", recompute: bool) -> "pa.Table":
    from benchnav.store.reading import read_results

    if not recompute:
        return read_results(run)
    from benchnav.runner.measured import measure_again

    return measure_again(run, metrics)


def _not_applicable(folder: "RunFolder") -> "list[NotApplicable]":
    from benchnav.leaderboard import NotApplicable

    return [
        NotApplicable(cell["navigator"], cell["scenario"], cell["track"], cell["reason"])
        for cell in folder.manifest.cells
        if cell["reason"]
    ]


def _warn_if_unfinished(folder: "RunFolder") -> None:
    first, stop = folder.manifest.suite["seeds"]
    cells = [cell for cell in folder.manifest.cells if not cell["reason"]]
    total = len(cells) * (stop - first)
    stored = sum(len(folder.done(cell["key"])) for cell in cells)
    if stored < total:
        say(
            f"{folder.path} holds {stored} of {total} episodes:"
            f" run the same suite with --out {folder.path} to finish it."
        )
