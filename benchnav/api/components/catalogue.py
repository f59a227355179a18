"""The names that can be given to `benchnav.run` and the other functions."""

from benchnav.errors import UsageError, did_you_mean
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS

_REGISTRIES = {
    "navigators": NAVIGATORS,
    "planners": PLANNERS,
    "controllers": CONTROLLERS,
    "metrics": METRICS,
    "trainers": TRAINERS,
}
KINDS = (*_REGISTRIES, "scenarios", "suites")


def available(kind: str) -> list[str]:
    """Return the names of a kind, sorted, as ``benchnav list`` shows them.

    Args:
        kind: navigators, planners, controllers, metrics, trainers, scenarios or suites.

    Nothing is imported for it, so a name may stand for a plugin that cannot be used.
    Raises UsageError for another kind.
    """
    from benchnav.runner.plan.suite_file import suite_names
    from benchnav.scenario.catalogue import names

    if kind in _REGISTRIES:
        return _REGISTRIES[kind].names()
    if kind == "scenarios":
        return names()
    if kind == "suites":
        return suite_names()
    raise UsageError(
        f"The kind must be one of {', '.join(KINDS)}. Got {kind!r} instead."
        f"{did_you_mean(kind, KINDS)}"
    )
