"""`benchnav doctor`: check this installation."""

from typing import Annotated

import typer

from benchnav.cli.console import put


def doctor(
    warm: Annotated[
        bool,
        typer.Option("--warm", help="First compile the kernels, so that no run waits for it."),
    ] = False,
) -> None:
    """Check this installation.

    It checks versions, cores, the user's folders, extras and plugins.
    """
    from benchnav.api.components.diagnosis import doctor as check

    found = check(warm=warm)
    put(found.text())
    if not found:
        raise typer.Exit(1)
