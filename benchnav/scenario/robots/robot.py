"""A robot: keys of a team that describe a body, with the source of each.

A robot is a YAML file: ``title``, the keys under ``team``, and under ``sources`` where the value
of each key is published.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import Field, model_validator

from benchnav.config.document import Document
from benchnav.config.validation import FieldError, validate
from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import did_you_mean
from benchnav.scenario.base import Spec
from benchnav.scenario.team import Team

KEYS = (
    "radius",
    "footprint",
    "max_speed",
    "preferred_speed",
    "max_turn_rate",
    "max_acceleration",
    "max_deceleration",
    "max_turn_acceleration",
    "dynamics",
)
ACCELERATIONS = ("max_acceleration", "max_deceleration", "max_turn_acceleration")
ESTIMATE = "estimate"  # begins the source of a value that is not published
_REPLACED_BY = {"footprint": "radius", "radius": "footprint", "preferred_speed": "max_speed"}
_ANY_PLACE = {"type": "points", "points": [[0.0, 0.0]]}


class RobotFile(Spec):
    """The content of a robot's file."""

    title: str = Field(min_length=1, max_length=200, description="one line, shown in lists")
    description: str = Field("", max_length=5000, description="purpose, and choices that were made")
    team: dict[str, Any] = Field(
        min_length=1, description=f"keys of a team: {', '.join(f'`{key}`' for key in KEYS)}"
    )
    sources: dict[str, str] = Field(
        {},
        description=f"for keys of `team`, where their value is published; `{ESTIMATE}: …` if it is"
        " not",
    )

    @model_validator(mode="after")
    def _check(self) -> "RobotFile":
        for key in self.team:
            if key not in KEYS:
                near = did_you_mean(key, KEYS) or f" A robot has {', '.join(KEYS)}."
                raise FieldError(("team", key), f"is not a key of a robot.{near}")
        for key in self.sources:
            if key not in self.team:
                raise FieldError(
                    ("sources", key),
                    f"must be a key of `team`.{did_you_mean(key, self.team)}",
                )
        return self


class _WithTeam(Spec):
    team: Team


@dataclass(frozen=True)
class Robot:
    """A robot that was read and checked."""

    title: str
    description: str
    keys: Mapping[str, Any]  # of a team, as plain data
    sources: Mapping[str, str]

    def keys_beside(self, team: Mapping[str, Any], acceleration_limits: bool) -> dict[str, Any]:
        """Return the keys that a team takes from this robot, beside its own keys.

        A team's own key replaces the robot's, and a `radius` replaces its `footprint` (and the
        other way round), because both are the body; a `max_speed` replaces its `preferred_speed`.
        """
        return {
            key: value
            for key, value in self.keys.items()
            if key not in team
            and _REPLACED_BY.get(key) not in team
            and (acceleration_limits or key not in ACCELERATIONS)
        }


def read_robot(path: Path) -> Robot:
    """Return the robot in the YAML file ``path``.

    Raises ScenarioError with ``file:line: key`` of each problem.
    """
    return robot_of(read_yaml(path))


def robot_of(document: Document) -> Robot:
    """Return the robot that ``document`` describes. Raises like `read_robot`."""
    file = validate(RobotFile, document)
    validate(_WithTeam, _as_scenario(document))
    return Robot(file.title, file.description.strip(), document.data["team"], file.sources)


def _as_scenario(document: Document) -> Document:
    """Return the robot as a team with any start and goal, so that the checks are those of teams."""
    team = {"name": "robot", "start": _ANY_PLACE, "goal": _ANY_PLACE, **document.data["team"]}
    return replace(document, data={"team": team})


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a robot's file."""
    schema, team = RobotFile.model_json_schema(), Team.model_json_schema()
    keys = {key: team["properties"][key] for key in KEYS}
    schema["properties"]["team"] |= {"properties": keys, "additionalProperties": False}
    schema["$defs"] = team["$defs"]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def is_robot(data: Any) -> bool:
    """Whether the content of a YAML file is that of a robot rather than a scenario or suite."""
    return isinstance(data, dict) and "team" in data and "teams" not in data
