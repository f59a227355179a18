"""`benchnav doctor`: check this installation."""

import typer

from benchnav.cli.console import put


def doctor() -> None:
    """Check this installation.

    It checks versions, cores, the user's folders, extras and plugins.
    """
    from benchnav.api.components.diagnosis import doctor as check

    found = check()
    put(found.text())
    if not found:
        raise typer.Exit(1)
