"""`benchnav show`: one component by name, with its parameters, units and source."""

from typing import Annotated

import typer

from benchnav.cli.console import put


def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Any name that `benchnav list` prints.")
    ],
) -> None:
    """Show a component by name.

    Purpose, parameters with units and defaults, and source.
    """
    from benchnav.api.components.page import show as page

    put(page(name).text)
