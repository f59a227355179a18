"""`benchnav new`: write a template of a plugin package."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.cli.stopping import stoppable

new_app = typer.Typer(help="Write a template of a plugin package.", no_args_is_help=True)


@new_app.callback()
def _kinds() -> None:
    """Keep `navigator` as a separate verb, although it is the only kind."""


@new_app.command("navigator")
@stoppable
def navigator(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Small letters, digits and hyphens.")],
    folder: Annotated[
        Path | None, typer.Option("--out", help="Folder to write. [default: ./NAME]")
    ] = None,
) -> None:
    """Write a complete navigator package: a module, an entry point, a test and a README."""
    from benchnav.api.authoring.new_navigator import new_navigator

    target = new_navigator(name, folder)
    put(str(target))
    say(f"Install and test it: pip install -e '{target}[test]' && pytest {target}")
    say(f"Run it: benchnav run quick --navigator {name} --navigator orca")
