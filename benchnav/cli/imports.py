"""`benchnav import`: other projects' maps become scenario files."""

import typer

import_app = typer.Typer(help="Make a scenario of a published map.", no_args_is_help=True)


@import_app.callback()
def _kinds() -> None:
    """Formats are verbs of their own."""
