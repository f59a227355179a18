"""A suite as a user gives it: a name, a file, a scenario, or the content of a suite file."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

from benchnav.api.execution.navigators import navigator_specs
from benchnav.api.records.scenario import Scenario
from benchnav.config.document import Document
from benchnav.config.yaml_reader import document_of

SuiteLike = str | PathLike[str] | Scenario | Mapping[str, Any]
"""Name or file of a suite or scenario, a scenario, or the content of a suite file."""


def suite_source(suite: SuiteLike) -> str | Document:
    """Return a suite as `load_suite` takes it: a name or file, or the content as a document.

    Raises UsageError for a navigator that is none, ScenarioError for other than plain data.
    """
    if not isinstance(suite, Mapping):
        return scenario_name(suite)
    content = dict(suite)
    if "navigators" in content:
        content["navigators"] = list(navigator_specs(content["navigators"]))
    if "scenarios" in content:
        content["scenarios"] = list(map(scenario_name, several(content["scenarios"])))
    return document_of(content, "suite")


def scenario_name(scenario: "str | Scenario | PathLike[str]") -> str:
    """Return the name or file of a scenario, as a suite file names it."""
    return scenario.name if isinstance(scenario, Scenario) else str(scenario)


def several(values: Any) -> list[Any]:
    """Return one value or several as a list; none for None."""
    if values is None:
        return []
    if isinstance(values, str | PathLike | Scenario):
        return [values]
    return list(values)
