"""Put the keys of robots into the teams that name them.

A scenario then holds numbers only: its hash, worlds and stored form do not depend on the robot's
file, so that two versions of a robot have different hashes and a stored run needs no package.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchnav.config.document import Document, PathKey, Place, shown
from benchnav.config.yaml_packages import SUFFIXES
from benchnav.errors import ScenarioError, UnknownPluginError, did_you_mean
from benchnav.scenario.robots.registry import find_robot, names
from benchnav.scenario.robots.robot import Robot

_STUB = {"radius": 1.0, "max_speed": 1.0}  # no complaint but the one about `robot` itself


def with_robots(document: Document, folder: Path) -> Document:
    """Return the document with the keys of robots in its teams; files are relative to ``folder``.

    Raises ScenarioError for an unknown robot, or one whose file is wrong.
    """
    data = document.data
    teams = data.get("teams") if isinstance(data, dict) else None
    if not isinstance(teams, list) or not any(map(_names_a_robot, teams)):
        return document
    place = document.place.children["teams"]
    filled, places = list(teams), dict(place.children)
    for i, team in enumerate(teams):
        if _names_a_robot(team):
            path = ("teams", i, "robot")
            keys = _keys(team, document.where(path), folder)
            filled[i] = {**keys, **team}
            places[i] = _placed(place.children[i], keys)
    around = {**document.place.children, "teams": Place(place.line, places)}
    return replace(
        document, data={**data, "teams": filled}, place=Place(document.place.line, around)
    )


def _names_a_robot(team: Any) -> bool:
    return isinstance(team, dict) and team.get("robot") is not None


def _keys(team: Mapping[str, Any], where: str, folder: Path) -> dict[str, Any]:
    """Return the keys that a team takes from its robot."""
    choice = team["robot"]
    fields = choice if isinstance(choice, dict) else {"type": choice}
    name, limits = fields.get("type"), fields.get("acceleration_limits", True)
    if not isinstance(name, str) or not isinstance(limits, bool):
        return Robot("", "", _STUB, {}).keys_beside(team, True)
    if name.endswith(SUFFIXES) and not _is_file(folder / name):
        raise ScenarioError(
            f"{where} must name a robot's file, relative to the scenario's own; {folder / name} is"
            " not a file."
        )
    try:
        return find_robot(name, folder).keys_beside(team, limits)
    except UnknownPluginError:
        raise ScenarioError(
            f"{where} must be the name of a robot, or a file that ends in {SUFFIXES[0]}; got"
            f" {shown(name)!r}.{did_you_mean(name[:100], names())} 'benchnav list robots' shows all"
            " robots."
        ) from None


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _placed(team: Place, keys: Iterable[PathKey]) -> Place:
    """Return the place of a team, in which the robot's keys have the line of `robot`."""
    line = team.children["robot"].line
    return Place(team.line, {**{key: Place(line) for key in keys}, **team.children})
