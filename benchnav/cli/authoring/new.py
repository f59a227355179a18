"""`benchnav new`: a plugin package to begin with."""

import re
from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.authoring.free_name import class_name, free_name, module_name, name_taken
from benchnav.cli.console import put, say
from benchnav.cli.stopping import stoppable
from benchnav.errors import StoreError, UsageError

new_app = typer.Typer(help="Write a plugin package to begin with.", no_args_is_help=True)

_PROJECT = """\
[build-system]
requires = ["setuptools>=80"]
build-backend = "setuptools.build_meta"

[project]
name = "{name}"
version = "0.1.0"
requires-python = ">=3.11"
dependencies = ["benchnav"]

[project.entry-points."benchnav.navigators"]
{name} = "{module}:{cls}"

[tool.setuptools]
py-modules = ["{module}"]
"""

_MODULE = '''\
"""Walks straight to the goal, and slows down near it. Replace `act_agent` with your idea."""

from benchnav.navigation.navigator import AgentNavigator, PluginConfig
from pydantic import Field


class {cls}(AgentNavigator):
    class Config(PluginConfig):
        pace: float = Field(1.0, gt=0, le=1, description="share of the preferred speed")

    def act_agent(self, view, briefing):
        way = view.goal - view.position
        speed = self.config.pace * briefing.preferred_speed[view.agent]
        return way * min(speed / max((way @ way) ** 0.5, 1e-9), 1 / briefing.dt)
'''

_README = """\
# {name}

A navigator for benchnav.

    pip install -e .
    benchnav show {name}
    benchnav run quick --navigator {name} --navigator orca
"""


@new_app.callback()
def _kinds() -> None:
    """Keep `navigator` a verb of its own while it is the only kind."""


@new_app.command("navigator")
@stoppable
def navigator(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Small letters, digits and hyphens.")],
    folder: Annotated[
        Path | None, typer.Option("--out", help="Where to write it. [default: ./NAME]")
    ] = None,
) -> None:
    """Write a complete navigator package: one module, one entry point, a README."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise UsageError(
            "NAME must be small letters, digits and single hyphens, a letter first."
            f" Got {name!r} instead."
        )
    if taken := name_taken(name):
        raise UsageError(f"NAME must be free. {taken}. {free_name(name)!r} would do.")
    target = folder if folder is not None else Path(name)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise UsageError(f"{target} must be missing or an empty folder. It holds something.")
    words = {
        "name": name,
        "module": module_name(name),
        "cls": class_name(name),
    }
    contents = {"pyproject.toml": _PROJECT, f"{words['module']}.py": _MODULE, "README.md": _README}
    try:
        target.mkdir(parents=True, exist_ok=True)
        for file, text in contents.items():
            (target / file).write_text(text.format(**words), encoding="utf-8")
    except OSError as error:
        raise StoreError(
            f"{target} must be writable. The system says: {error.strerror}."
        ) from error
    put(str(target))
    say(
        f"Try it: pip install -e {target} && benchnav run quick --navigator {name} --navigator orca"
    )
