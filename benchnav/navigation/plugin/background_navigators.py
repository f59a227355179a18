"""Check the navigators that scenarios name as drivers of their background teams."""

from collections.abc import Iterator
from typing import Any

from benchnav.errors import BenchnavError, PluginError, ScenarioError, did_you_mean
from benchnav.navigation.plugin.configure import configure, split
from benchnav.navigation.plugin.plugin_process import (
    CONFIG,
    TIMEOUT,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
from benchnav.plugins import NAVIGATORS
from benchnav.processes.channel import Channel
from benchnav.scenario.scenario import Scenario
from benchnav.source.parts import local_names


def check_drivers(*scenarios: Scenario, timeout: float = TIMEOUT) -> None:
    """Raise ScenarioError if a team's driver is not a navigator or refuses its parameters.

    The message lists ``file:line: key`` of all errors of the first scenario that has errors.
    Nothing is constructed. Classes are loaded in separate processes, in which a call may last
    ``timeout`` [s]; classes that only this process knows are loaded here.
    """
    drivers = [list(_drivers(scenario)) for scenario in scenarios]
    away = [driver for group in drivers for driver in group if not _is_known_here(driver)]
    groups = [[d for d in away if d.name == name] for name in dict.fromkeys(d.name for d in away)]
    answers = query_plugins(f"{__name__}:serve_drivers", groups, timeout)
    found = {
        id(driver): answer
        for group, answered in zip(groups, answers, strict=True)
        for driver, answer in zip(group, answered, strict=True)
    }
    for group in drivers:
        refused = [(d, found[id(d)] if id(d) in found else _error_of(d)) for d in group]
        complaints = [_complaint(d, e) for d, e in refused if isinstance(e, BenchnavError)]
        if complaints:
            raise ScenarioError("\n".join(complaints))


def serve_drivers(channel: Channel, notes: "memoryview[float]") -> None:
    """Check the drivers that the channel requests. Runs in a separate process."""
    serve(channel, notes, _check)


def _check(question: Any, on_step: StepCallback) -> None:
    places = question["places"]
    on_step(CONFIG)
    configure(NAVIGATORS, question["spec"], where=lambda key: places.get(key, places[""]))


def _drivers(scenario: Scenario) -> Iterator[Plugin]:
    for i, team in enumerate(scenario.teams):
        if team.evaluated:
            continue
        path = ("teams", i, "driver")
        spec = {"type": team.driver.type, **team.driver.params}
        places = {key: scenario.where((*path, key)) for key in spec}
        places[""] = scenario.where(path)
        question = {"spec": spec, "places": places}
        yield Plugin(NAVIGATORS.kind, team.driver.type, "", question)


def _is_known_here(driver: Plugin) -> bool:
    try:
        name, parameters = split(NAVIGATORS, driver.question["spec"])
    except PluginError:  # any process refuses it
        return False
    return bool(local_names({"type": name, **parameters}))


def _error_of(driver: Plugin) -> BenchnavError | None:
    """Return the error of a driver that only this process knows, or None."""
    try:
        _check(driver.question, lambda step: None)
    except PluginError as error:
        return error
    return None


def _complaint(driver: Plugin, error: BenchnavError) -> str:
    text, places = str(error), driver.question["places"]
    named = text.startswith(tuple(places.values()))
    near = did_you_mean(driver.name, ["evaluated"])
    return (text if named else f"{places['type']}: {text}") + near
