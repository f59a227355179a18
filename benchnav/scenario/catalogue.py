"""Scenarios by name: those of installed packages, and files."""

from pathlib import Path

from benchnav.config.yaml_packages import SUFFIXES, only, scenario_files
from benchnav.errors import UnknownPluginError, did_you_mean
from benchnav.scenario.load import load_scenario
from benchnav.scenario.parameters import split_parameters
from benchnav.scenario.scenario import Scenario


def names() -> list[str]:
    """Return the names of all installed scenarios, sorted, without reading any."""
    return list(scenario_files())


def origin(name: str) -> str:
    """Return the distribution that a scenario comes from."""
    return " and ".join(file.distribution for file in scenario_files()[name])


def find(name: str, folder: Path = Path()) -> Scenario:
    """Return the scenario ``name`` or ``name@version``, or of a file relative to ``folder``.

    A suffix ``:key=value,key=value`` sets its parameters.

    Raises:
        UsageError: an unknown parameter, or a value that is not allowed.
        UnknownPluginError: an unknown name, or another version.
        ScenarioError: its file is wrong.
        PluginConflictError: two packages hold a scenario of this name.
    """
    base, given = split_parameters(name)
    if base.endswith(SUFFIXES):
        return load_scenario(folder / base, given)
    bare, _, version = base.partition("@")
    files = scenario_files()
    if bare not in files:
        raise UnknownPluginError(
            f"No scenario is called {bare!r}.{did_you_mean(bare, names())}"
            " 'benchnav list scenarios' shows all; the name of a file ends in .yaml."
        )
    scenario = load_scenario(only("scenario", files[bare]).path, given)
    if version and version != str(scenario.version):
        raise UnknownPluginError(
            f"The scenario {bare!r} is at version {scenario.version}; got {name!r}."
        )
    return scenario


def is_named(name: str) -> bool:
    """Whether ``name`` is a known scenario or the name of a file."""
    base, _ = split_parameters(name)
    return base.endswith(SUFFIXES) or base.partition("@")[0] in names()
