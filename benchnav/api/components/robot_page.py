"""The page of a robot: the keys that it gives a team, each with its source."""

from pathlib import Path
from textwrap import fill
from typing import Any

from benchnav.config.yaml_packages import SUFFIXES
from benchnav.text.columns import columns

WIDTH = 100  # of a page [characters]


def describes_robot(name: str) -> bool:
    """Whether ``name`` is the file of a robot."""
    from benchnav.config.yaml_reader import read_yaml
    from benchnav.errors import ScenarioError
    from benchnav.scenario.robots.robot import is_robot

    if not name.endswith(SUFFIXES) or not Path(name).is_file():
        return False
    try:
        return is_robot(read_yaml(name).data)
    except ScenarioError:
        return False


def robot_page(name: str) -> str:
    """Return the page of a robot, by name or file."""
    from benchnav.scenario.robots import registry

    robot = registry.find_robot(name)
    place = name if name.endswith(SUFFIXES) else registry.origin(name)
    facts = [("is", f"a robot: {robot.title}"), ("comes from", place)]
    facts.append(("use it", f"robot: {name} in a team of a scenario"))
    page = [name, columns([("  " + key, value) for key, value in facts])]
    if robot.description:
        page += ["", fill(robot.description, WIDTH), ""]
    page.append("  keys of a team")
    for key, value in robot.keys.items():
        page.append(f"    {key}: {as_yaml(value)}")
        if key in robot.sources:
            indent = " " * 6
            source = f"source: {robot.sources[key].strip()}"
            page.append(fill(source, WIDTH, initial_indent=indent, subsequent_indent=indent))
    return "\n".join(page)


def as_yaml(value: Any) -> str:
    """Return plain data as YAML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {as_yaml(part)}" for key, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_yaml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, int | float) else str(value)
