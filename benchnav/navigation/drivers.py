"""The navigators that a scenario names as drivers of its teams."""

from benchnav.errors import PluginError, ScenarioError, did_you_mean
from benchnav.navigation.configure import configure
from benchnav.plugins import NAVIGATORS
from benchnav.scenario.scenario import Scenario


def check_drivers(scenario: Scenario) -> None:
    """Raise ScenarioError where a team's driver is no navigator, or refuses its parameters.

    Each complaint says ``file:line: key``. Nothing is constructed.
    """
    complaints = []
    for i, team in enumerate(scenario.teams):
        if team.evaluated:
            continue

        def where(parameter: str, i: int = i) -> str:
            path = ("teams", i, "driver")
            return scenario.where((*path, parameter) if parameter else path)

        try:
            configure(NAVIGATORS, {"type": team.driver.type, **team.driver.params}, where=where)
        except PluginError as error:
            text = str(error)
            named = text.startswith((where(""), *map(where, team.driver.params)))
            complaints.append(text if named else f"{where('type')}: {text}")
            complaints[-1] += did_you_mean(team.driver.type, ["evaluated"])
    if complaints:
        raise ScenarioError("\n".join(complaints))
