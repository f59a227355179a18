"""Robots by name: those of installed packages, of this process, and files.

A package is named by an entry point, ``mine = "my_robots"``, in the group `benchnav.robots`. Its
folder holds ``<robot>.yaml``. The folder is found without importing the package.
"""

import re
from pathlib import Path
from typing import Any

from benchnav.config.yaml_packages import SUFFIXES, only, robot_files
from benchnav.config.yaml_reader import document_of
from benchnav.errors import PluginConflictError, UnknownPluginError, UsageError, did_you_mean
from benchnav.scenario.robots.robot import Robot, read_robot, robot_of

IN_PROCESS = "registered in this process"
_NAME = re.compile(r"[a-z0-9]+([_-][a-z0-9]+)*")

_registered: dict[str, Robot] = {}


def register_robot(name: str, title: str = "", **keys: Any) -> None:
    """Register a robot in this process, which a team takes by ``robot: NAME``.

    For example ``register_robot("cart", radius=0.4, max_speed=1.2, max_acceleration=0.8)``.
    Registering a name again replaces its robot.

    Args:
        name: small letters, digits and hyphens.
        title: one line, shown in lists.
        keys: of a team, as in a scenario file, with plain data as values.

    Raises:
        UsageError: the name has other characters.
        PluginConflictError: an installed robot has the name.
        ScenarioError: a key or a value is wrong.
    """
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise UsageError(
            "The name of a robot must be made of small letters, digits and hyphens."
            f" Got {name!r} instead."
        )
    if name in robot_files():
        raise PluginConflictError(
            f"The robot name {name!r} is claimed more than once: {origin(name)} and this process."
            " Register it under another name."
        )
    content = {"title": title or f"A robot, {IN_PROCESS}", "team": keys}
    _registered[name] = robot_of(document_of(content, f"robot {name!r}"))


def names() -> list[str]:
    """Return the names of all robots, sorted, without reading any."""
    return sorted({*robot_files(), *_registered})


def origin(name: str) -> str:
    """Return the distribution that a robot comes from."""
    if name in _registered:
        return IN_PROCESS
    return " and ".join(file.distribution for file in robot_files()[name])


def find_robot(name: str, folder: Path = Path()) -> Robot:
    """Return the robot ``name``, or the one in a file relative to ``folder``.

    Raises:
        UnknownPluginError: an unknown name.
        PluginConflictError: two packages hold a robot of this name.
        ScenarioError: its file is wrong.
    """
    if name.endswith(SUFFIXES):
        return read_robot(folder / name)
    if name in _registered:
        return _registered[name]
    files = robot_files()
    if name not in files:
        raise UnknownPluginError(
            f"There is no robot {name!r}.{did_you_mean(name, names())} 'benchnav list robots'"
            " shows all; the name of a file ends in .yaml."
        )
    return read_robot(only("robot", files[name]).path)
