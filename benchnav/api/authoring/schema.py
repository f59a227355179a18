"""The JSON Schema of scenario, suite and robot files."""

from typing import Any

from benchnav.errors import UsageError, did_you_mean

KINDS = ("scenario", "suite", "robot")


def schema(kind: str = "scenario") -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of scenario, suite or robot files, as plain data.

    Editors use it to complete and check files.

    Args:
        kind: "scenario", "suite" or "robot".

    Raises UsageError for another kind.
    """
    if kind not in KINDS:
        raise UsageError(
            "A schema must be that of a scenario, suite or robot file. Got {kind!r} instead."
            f"{did_you_mean(str(kind), KINDS)}"
        )
    if kind == "suite":
        from benchnav.runner.plan.suite_file import json_schema
    elif kind == "robot":
        from benchnav.scenario.robots.robot import json_schema
    else:
        return _scenario_schema()
    return json_schema()


def _scenario_schema() -> dict[str, Any]:
    """Return the schema of scenario files, which offers the names of the installed robots."""
    from benchnav.scenario.load import json_schema
    from benchnav.scenario.robots.registry import names

    found = json_schema()
    offered = {"enum": names()}
    found["$defs"]["Team"]["properties"]["robot"]["anyOf"].insert(0, offered)
    found["$defs"]["RobotChoice"]["properties"]["type"]["anyOf"].insert(0, offered)
    return found
