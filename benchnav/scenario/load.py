"""Load scenarios from files."""

from pathlib import Path
from typing import Any

from benchnav.config.document import Document, PathKey
from benchnav.config.validation import validate
from benchnav.config.yaml_reader import read_yaml, read_yaml_text
from benchnav.errors import ScenarioError
from benchnav.scenario.parameters import Given, Reference, resolve
from benchnav.scenario.robots.robot import KEYS as BODY_KEYS
from benchnav.scenario.robots.team_keys import with_robots
from benchnav.scenario.scenario import Scenario


def load_scenario(path: Path | str, given: Given | None = None) -> Scenario:
    """Return the scenario in the YAML file ``path``, with the parameters ``given``.

    Raises:
        UsageError: an unknown parameter, or a value that is not allowed.
        ScenarioError: with ``file:line: key`` of each problem, up to ten.
    """
    return scenario_of(read_yaml(path), Path(path).parent, given)


def scenario_from_text(text: str, name: str, folder: Path | str = ".") -> Scenario:
    """Return the scenario in ``text``; messages use ``name`` as the file name.

    Raises:
        ScenarioError: like `load_scenario`.
    """
    return scenario_of(read_yaml_text(text, name), Path(folder))


def scenario_of(document: Document, folder: Path, given: Given | None = None) -> Scenario:
    """Return the scenario that ``document`` describes; paths of its files start at ``folder``.

    Raises what `load_scenario` raises.
    """
    document, chosen = resolve(document, given or {})
    document = with_robots(document, folder)
    scenario = validate(Scenario, document)
    scenario = scenario.placed_in(folder, chosen, _places_of_teams(document))
    for key, path in scenario.files():
        if not _is_file(path):
            raise ScenarioError(
                f"{document.where(key)} must name a file, relative to the scenario's own;"
                f" {path} is not one."
            )
    return scenario


def _places_of_teams(document: Document) -> dict[tuple[PathKey, ...], str]:
    """Return the places of teams, their parts, and the parts of these in the file."""
    paths: list[tuple[PathKey, ...]] = []
    for i, team in document.place.children["teams"].children.items():
        for key, part in team.children.items():
            paths += [("teams", i, key), *(("teams", i, key, inner) for inner in part.children)]
        paths.append(("teams", i))
    return {path: document.where(path) for path in paths}


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a scenario file."""
    schema = Scenario.model_json_schema()
    _allow_references({key: part for key, part in schema.items() if key != "$defs"})
    _allow_references({k: part for k, part in schema["$defs"].items() if k != "Parameter"})
    _offer_robots(schema["$defs"]["Team"], schema["$defs"]["RobotChoice"])
    schema["$defs"]["Reference"] = Reference.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


_OF_NUMBERS = ("type", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


def _allow_references(node: Any) -> None:
    """Allow a parameter wherever a number, or true or false, is allowed."""
    for child in list(node.values() if isinstance(node, dict) else node):
        if isinstance(child, dict | list):
            _allow_references(child)
    if isinstance(node, dict) and node.get("type") in ("number", "integer", "boolean"):
        number = {key: node.pop(key) for key in _OF_NUMBERS if key in node}
        node["anyOf"] = [number, {"$ref": "#/$defs/Reference"}]


def _offer_robots(team: dict[str, Any], choice: dict[str, Any]) -> None:
    """Allow a parameter as a robot's name, and a robot in place of the keys that it gives."""
    reference = {"$ref": "#/$defs/Reference"}
    name = choice["properties"]["type"]
    name["anyOf"] = [{"type": name.pop("type")}, reference]
    team["properties"]["robot"]["anyOf"].append(reference)
    body = [key for key in team["required"] if key in BODY_KEYS]
    team["required"] = [key for key in team["required"] if key not in BODY_KEYS]
    team["anyOf"] = [{"required": ["robot"]}, {"required": body}]
