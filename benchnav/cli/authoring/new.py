"""`benchnav new`: write a template of a plugin package."""

import re
from pathlib import Path
from typing import Annotated

import typer

from benchnav.api.authoring.free_name import free_name, name_taken
from benchnav.api.authoring.navigator_template import navigator_package
from benchnav.cli.console import put, say
from benchnav.cli.stopping import stoppable
from benchnav.errors import StoreError, UsageError

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
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise UsageError(
            "NAME must be small letters, digits and single hyphens, a letter first."
            f" Got {name!r} instead."
        )
    if taken := name_taken(name):
        raise UsageError(f"NAME must be free. {taken}. {free_name(name)!r} would do.")
    target = folder if folder is not None else Path(name)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise UsageError(f"{target} must be missing or an empty folder. It is not empty.")
    try:
        for file, text in navigator_package(name).items():
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            (target / file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise StoreError(
            f"{target} must be writable. The system says: {error.strerror}."
        ) from error
    put(str(target))
    say(f"Install and test it: pip install -e '{target}[test]' && pytest {target}")
    say(f"Run it: benchnav run quick --navigator {name} --navigator orca")
