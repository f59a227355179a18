"""Scenarios from files."""

from pathlib import Path
from typing import Any

from benchnav.errors import ScenarioError
from benchnav.scenario.document import Document
from benchnav.scenario.scenario import Scenario
from benchnav.scenario.validation import validate
from benchnav.scenario.yaml_reader import read_yaml, read_yaml_text


def load_scenario(path: Path | str) -> Scenario:
    """The scenario in the YAML file ``path``.

    Raises:
        ScenarioError: with ``file:line: key`` of everything that is wrong, up to ten complaints.
    """
    return _checked(read_yaml(path), Path(path).parent)


def scenario_from_text(text: str, name: str, folder: Path | str = ".") -> Scenario:
    """The scenario in ``text``; ``name`` stands for the file in messages.

    Raises:
        ScenarioError: as `load_scenario`.
    """
    return _checked(read_yaml_text(text, name), Path(folder))


def _checked(document: Document, folder: Path) -> Scenario:
    scenario = validate(Scenario, document).placed_in(folder)
    for key, path in scenario.files():
        if not _is_file(path):
            raise ScenarioError(
                f"{document.where(key)} must name a file, relative to the scenario's own;"
                f" {path} is not one."
            )
    return scenario


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a scenario file."""
    schema = Scenario.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
