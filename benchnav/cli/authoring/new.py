"""`benchnav new`: write a template of a plugin package."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.cli.stopping import stoppable

new_app = typer.Typer(help="Write a template of a plugin package.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(metavar="NAME", help="Small letters, digits and hyphens.")]
Folder = Annotated[Path | None, typer.Option("--out", help="Folder to write. [default: ./NAME]")]


@new_app.command("navigator")
@stoppable
def navigator(name: Name, folder: Folder = None) -> None:
    """Write a complete navigator package: a module, an entry point, a test and a README."""
    _write("navigator", name, folder, f"benchnav run quick --navigator {name} --navigator orca")


@new_app.command("planner")
@stoppable
def planner(name: Name, folder: Folder = None) -> None:
    """Write a complete planner package: a module, an entry point, a test and a README."""
    _write("planner", name, folder, f"benchnav run quick --navigator {name}+orca")


@new_app.command("controller")
@stoppable
def controller(name: Name, folder: Folder = None) -> None:
    """Write a complete controller package: a module, an entry point, a test and a README."""
    _write("controller", name, folder, f"benchnav run quick --navigator grid.astar+{name}")


@new_app.command("metric")
@stoppable
def metric(name: Name, folder: Folder = None) -> None:
    """Write a complete metric package: a module, an entry point, a test and a README."""
    use = f"benchnav leaderboard RUN --recompute --metric {name.replace('-', '_')}"
    _write("metric", name, folder, use)


@new_app.command("scenario-pack")
@stoppable
def scenario_pack(name: Name, folder: Folder = None) -> None:
    """Write a complete package of scenarios with a suite, entry points, a test and a README."""
    _write("scenario-pack", name, folder, f"benchnav run {name} --out runs/first")


def _write(kind: str, name: str, folder: Path | None, use: str) -> None:
    from benchnav.api.authoring.new_package import new_package

    target = new_package(kind, name, folder)
    put(str(target))
    say(f"Install and test it: pip install -e '{target}[test]' && pytest {target}")
    say(f"Run it: {use}")
