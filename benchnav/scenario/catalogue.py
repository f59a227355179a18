"""Scenarios by name: those that ship, those that plugins register, and files."""

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from benchnav.errors import PluginError, UnknownPluginError, UsageError, did_you_mean
from benchnav.plugins import SCENARIOS
from benchnav.scenario.load import load_scenario
from benchnav.scenario.parameters import Given, split_parameters
from benchnav.scenario.scenario import Scenario

_SHIPPED = "benchnav_scenarios"  # found by name: benchnav never imports it
_ENDINGS = (".yaml", ".yml")


def names() -> list[str]:
    """Every scenario that has a name, sorted, without reading any."""
    return sorted({*_shipped(), *SCENARIOS.names()})


def find(name: str, folder: Path = Path()) -> Scenario:
    """The scenario called ``name``, ``name@version``, or the one in a file, from ``folder``.

    ``:key=number,key=number`` behind any of them sets its parameters.

    Raises:
        UsageError: it does not have such a parameter, or a number is out of its bounds.
        UnknownPluginError: there is none, or it has another version.
        ScenarioError: its file is wrong.
        PluginError: a plugin registered something that is not a scenario.
    """
    base, given = split_parameters(name)
    if base.endswith(_ENDINGS):
        return load_scenario(folder / base, given)
    bare, _, version = base.partition("@")
    shipped = _shipped()
    if bare in shipped:
        scenario = load_scenario(shipped[bare], given)
    elif bare in SCENARIOS.names() or ":" in bare:
        scenario = _from_plugin(bare, SCENARIOS.load(bare), given)
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


def _from_plugin(name: str, thing: Any, given: Given) -> Scenario:
    if callable(thing) and not isinstance(thing, Scenario):
        thing = thing()
    if isinstance(thing, str | Path):
        return load_scenario(thing, given)
    if given:
        raise UsageError(f"The scenario {name!r} is no file, so it has no parameters to set.")
    if isinstance(thing, Scenario):
        return thing
    raise PluginError(
        f"The scenario plugin {name!r} must be a Scenario, the path of a YAML file, or a function"
        f" that returns one; got {type(thing).__name__}."
    )


def is_named(name: str) -> bool:
    """True where `find` would look for a scenario: a name that is known, or a file's."""
    base, _ = split_parameters(name)
    return base.endswith(_ENDINGS) or base.partition("@")[0] in names()


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
