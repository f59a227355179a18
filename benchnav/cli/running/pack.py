"""`benchnav pack`: a run as one file for other people."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def pack(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The pack. [default: RUN.bnrun]")
    ] = None,
) -> None:
    """Make one file of a run, with everything that is needed to verify it.

    `benchnav verify` checks the file without the navigators. Prints the path of the file.
    """
    from benchnav.api.records.run import open_run

    put(str(open_run(run).pack(out)))
