"""`benchnav validate`: check a scenario, suite or robot file."""

from typing import Annotated

import typer

from benchnav.cli.console import put


def validate(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE|NAME",
            help="A scenario, suite or robot: its file or name. A scenario may have parameters:"
            " NAME:key=value.",
        ),
    ],
    draw: Annotated[
        bool,
        typer.Option(help="Also draw worlds of a scenario: are they solvable, do they differ?"),
    ] = True,
) -> None:
    """Check a scenario, suite or robot.

    Each problem is reported as file:line: key.
    """
    from benchnav.api.authoring.validate import validate as check

    found = check(file, draw=draw)
    if found.facts:
        put(found.facts)
    if found.error is not None:
        raise found.error
