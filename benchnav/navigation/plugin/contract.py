"""The contracts of navigators, planners and controllers, which their registries check."""

import inspect
from typing import Any

from pydantic import BaseModel

from benchnav.navigation.controller import Controller
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.planner import Planner


def navigator_rule(name: str, plugin: Any) -> str:
    """Return the rule that the navigator ``name`` violates; "" if there is none."""
    return _class_rule(Navigator, plugin)


def planner_rule(name: str, plugin: Any) -> str:
    """Return the rule that the planner ``name`` violates; "" if there is none."""
    return _class_rule(Planner, plugin)


def controller_rule(name: str, plugin: Any) -> str:
    """Return the rule that the controller ``name`` violates; "" if there is none."""
    return _class_rule(Controller, plugin)


def _class_rule(base: type[Navigator | Planner | Controller], plugin: Any) -> str:
    if not (isinstance(plugin, type) and issubclass(plugin, base)):
        return f"be a class derived from {base.__module__}.{base.__qualname__}"
    if not (isinstance(plugin.Config, type) and issubclass(plugin.Config, BaseModel)):
        return "be a class with a pydantic Config"
    if inspect.isabstract(plugin):
        missing = ", ".join(sorted(plugin.__abstractmethods__))
        return f"be a class that implements {missing}"
    return ""
