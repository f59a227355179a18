"""`benchnav list`: all installed components, and the broken ones."""

from typing import Annotated

import typer

from benchnav.cli.console import put


def list_(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="KIND",
            help="navigators, planners, controllers, scenarios, robots, suites, metrics, trainers"
            " or recipes. [default: all]",
        ),
    ] = None,
) -> None:
    """List the names of all components, and the broken ones."""
    from benchnav.api.components.catalogue import available

    if kind is not None:
        put(available(kind).text())
        return
    for number, (each, components) in enumerate(available().items()):
        put(f"{'' if number == 0 else chr(10)}{each}")
        put(components.text(indent="  "))
