"""The kinds of components, and the registries of those that are plugins."""

from enum import StrEnum

from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS


class Kind(StrEnum):
    """The kinds that can be listed."""

    NAVIGATORS = "navigators"
    PLANNERS = "planners"
    CONTROLLERS = "controllers"
    SCENARIOS = "scenarios"
    ROBOTS = "robots"
    SUITES = "suites"
    METRICS = "metrics"
    TRAINERS = "trainers"
    RECIPES = "recipes"


REGISTRIES = {
    Kind.NAVIGATORS: NAVIGATORS,
    Kind.PLANNERS: PLANNERS,
    Kind.CONTROLLERS: CONTROLLERS,
    Kind.METRICS: METRICS,
    Kind.TRAINERS: TRAINERS,
}
