"""Scenarios by name: those that ship, those that plugins register, and files."""

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from benchnav.errors import PluginError, UnknownPluginError, did_you_mean
from benchnav.plugins import SCENARIOS
from benchnav.scenario.load import load_scenario
from benchnav.scenario.scenario import Scenario

_SHIPPED = "benchnav_scenarios"  # found by name: benchnav never imports it
_ENDINGS = (".yaml", ".yml")


def names() -> list[str]:
    """Every scenario that has a name, sorted, without reading any."""
    return sorted({*_shipped(), *SCENARIOS.names()})


def find(name: str) -> Scenario:
    """The scenario called ``name``, ``name@version``, or the one in the file ``name``.

    Raises:
        UnknownPluginError: there is none, or it has another version.
        ScenarioError: its file is wrong.
        PluginError: a plugin registered something that is not a scenario.
    """
    if name.endswith(_ENDINGS):
        return load_scenario(name)
    bare, _, version = name.partition("@")
    shipped = _shipped()
    if bare in shipped:
        scenario = load_scenario(shipped[bare])
    elif bare in SCENARIOS.names() or ":" in bare:
        scenario = _from_plugin(bare, SCENARIOS.load(bare))
    else:
        raise UnknownPluginError(
            f"No scenario is called {bare!r}.{did_you_mean(bare, names())}"
            " 'benchnav list scenarios' shows all; a file's name ends in .yaml."
        )
    if version and version != str(scenario.version):
        raise UnknownPluginError(
            f"The scenario {bare!r} is at version {scenario.version}; got {name!r}."
        )
    return scenario


def _from_plugin(name: str, thing: Any) -> Scenario:
    if callable(thing) and not isinstance(thing, Scenario):
        thing = thing()
    if isinstance(thing, str | Path):
        return load_scenario(thing)
    if isinstance(thing, Scenario):
        return thing
    raise PluginError(
        f"The scenario plugin {name!r} must be a Scenario, the path of a YAML file, or a function"
        f" that returns one; got {type(thing).__name__}."
    )


def _shipped() -> dict[str, Path]:
    """Name → file of every scenario that ships (suites are not scenarios)."""
    try:
        root = resources.files(_SHIPPED)
    except ModuleNotFoundError:
        return {}
    found: dict[str, Path] = {}
    for family in root.iterdir():
        if family.is_dir() and family.name != "suites" and not family.name.startswith(("_", ".")):
            for file in family.iterdir():
                if file.name.endswith(_ENDINGS):
                    found[f"{family.name}/{file.name.rsplit('.', 1)[0]}"] = _path(file)
    return found


def _path(file: Traversable) -> Path:
    return Path(str(file))
