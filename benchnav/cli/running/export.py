"""`benchnav export`: the trajectories of a run for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def export(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder or pack.")],
    out: Annotated[
        Path, typer.Option(metavar="PATH", help="File of the table; for pedpy, a folder.")
    ],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="FORMAT",
            help="csv, parquet, or pedpy: files that PedPy loads. [default: by the suffix of PATH]",
        ),
    ] = None,
    navigator: Annotated[str | None, typer.Option(help="Only this navigator.")] = None,
    scenario: Annotated[str | None, typer.Option(help="Only this scenario.")] = None,
    track: Annotated[str | None, typer.Option(help="Only this track.")] = None,
    perception: Annotated[
        str | None, typer.Option(help="Only this perception: exact or noisy.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Only this seed.")] = None,
) -> None:
    """Write trajectories as a table, or as files that PedPy loads.

    `benchnav score` reads the table. Prints the paths of the files.
    """
    from benchnav.api.records.run import open_run

    with open_run(run) as opened:
        files = opened.export(
            out, to=to, navigator=navigator, scenario=scenario, track=track,
            perception=perception, seed=seed,
        )  # fmt: skip
    put("\n".join(str(file) for file in files))
