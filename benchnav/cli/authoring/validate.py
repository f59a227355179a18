"""`benchnav validate`: check a scenario, suite or robot file."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def validate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A scenario, suite or robot file.")],
    draw: Annotated[
        bool,
        typer.Option(help="Also draw worlds of a scenario: are they solvable, do they differ?"),
    ] = True,
) -> None:
    """Check a scenario, suite or robot file.

    Each problem is reported as file:line: key.
    """
    from benchnav.api.authoring.validate import validate as check

    found = check(file, draw=draw)
    if found.facts:
        put(found.facts)
    if found.error is not None:
        raise found.error
