"""`benchnav verify`: check everything that a run stores."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def verify(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder or pack.")],
    twin: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, help="Episodes that the slow twin of the kernels replays as well."
        ),
    ] = 20,
    twin_seconds: Annotated[
        float,
        typer.Option(
            metavar="S", min=0.0, help="Processor time for these replays; each has an equal share."
        ),
    ] = 20.0,
    referee: Annotated[
        str | None,
        typer.Option(help="Library that checks every contact a second time: fcl."),
    ] = None,
    rerun: Annotated[
        bool, typer.Option("--rerun", help="Run the navigators again where they are deterministic.")
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=0, max=1024, help="Processes. [default: one per core]"),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the findings as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Check a run without its navigators.

    Draws its worlds again, re-simulates its commands, measures its metrics, and names every
    stored number that does not agree. The exit status is 1 if there are any.
    """
    from benchnav.api.records.run import open_run
    from benchnav.system.pandas_import import delay_pandas

    delay_pandas()
    with open_run(run) as opened:
        found = opened.verify(
            twin=twin, twin_seconds=twin_seconds, referee=referee, rerun=rerun, workers=workers,
            quiet=quiet,
        )  # fmt: skip
    put(found.to_json() if json else found.text())
    if not found.verified:
        raise typer.Exit(1)
