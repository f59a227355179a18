"""Names of navigators that consist of parts. The parts are in the order of processing.

``PLANNER+CONTROLLER``            a planner on the granted map, a controller along its path
``none+CONTROLLER``               only a controller, whose target is the goal; needs no map
``mapping+PLANNER+CONTROLLER``    a planner on the map that the agent builds from its sensors

Such a name is a short form of a `hierarchical` navigator, wherever a navigator is
named: ``ompl.bit-star+orca`` means ``{type: hierarchical, planner: ompl.bit-star,
controller: orca}``. Other parameters follow the name, and the parameters of a part are
under its kind: ``{type: ompl.prm+orca, replan: never, controller: {margin: 0.1}}``.
"""

from collections.abc import Mapping
from typing import Any

from benchnav.errors import ConfigError, UnknownPluginError, did_you_mean
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS, Registry

HIERARCHICAL = "hierarchical"  # the registered navigator of every pair
NO_PLANNER = "none"
MAPPING = "mapping"


def is_pair(name: str) -> bool:
    """Whether a navigator is named by its parts."""
    return "+" in name and name not in NAVIGATORS.names()


def hint(name: str) -> str:
    """Return how to name a navigator with the part ``name``; "" if it is not a part."""
    if name in PLANNERS.names():
        return f" It is a planner: {name}+CONTROLLER is a navigator."
    if name in CONTROLLERS.names():
        return f" It is a controller: PLANNER+{name} and {NO_PLANNER}+{name} are navigators."
    return ""


def parameters_of(name: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of `hierarchical` for the pair ``name`` with the parameters ``given``.

    Raises:
        ConfigError: the name is not a pair's, or a parameter contradicts it.
        UnknownPluginError: a part does not exist; the message suggests the nearest name.
    """
    *before, planner, controller = name.split("+")
    if before not in ([], [MAPPING]) or not (planner and controller):
        near = did_you_mean(before[0], [MAPPING]) if before else ""
        raise ConfigError(
            "A navigator named by its parts must be PLANNER+CONTROLLER, none+CONTROLLER or"
            f" mapping+PLANNER+CONTROLLER. Got {name!r} instead.{near}"
        )
    if planner != NO_PLANNER:
        _require(PLANNERS, planner, name)
    _require(CONTROLLERS, controller, name)
    parts: dict[str, Any] = {PLANNERS.kind: planner, CONTROLLERS.kind: controller}
    if before:
        parts[MAPPING] = True
    for key in parts.keys() & given.keys():
        parts[key] = _refined(name, key, parts[key], given[key])
    return {**given, **parts}


def _require(registry: Registry, part: str, name: str) -> None:
    try:
        registry.source(part)
    except UnknownPluginError as error:
        raise UnknownPluginError(f"In the navigator {name!r}: {error}") from None


def _refined(name: str, key: str, named: Any, given: Any) -> Any:
    """Return the part ``named`` with the parameters ``given`` under its kind."""
    if isinstance(given, Mapping) and "type" not in given and named != NO_PLANNER:
        return dict(given) if named is True else {"type": named, **given}
    raise ConfigError(
        f"The navigator {name!r} names its {key}: the parameter {key!r} must be a mapping of that"
        f" {key}'s parameters. Got {given!r} instead."
    )
