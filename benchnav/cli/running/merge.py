"""`benchnav merge`: one run of several that share a suite."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def merge(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN…", help="Run folders of one suite.")],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Run folder that gets everything.")],
) -> None:
    """Merge runs that executed shares of one suite.

    Prints the merged run on stdout, and names its missing episodes. Episodes that several
    runs hold must be the same.
    """
    from benchnav.api.execution.merge import merge as merged

    put(str(merged(runs, out).path))
