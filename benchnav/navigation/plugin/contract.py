"""What plugins of the navigation layer must be; their registries ask it."""

import inspect
from typing import Any

from pydantic import BaseModel

from benchnav.navigation.controller import Controller
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.planner import Planner


def navigator_rule(name: str, plugin: Any) -> str:
    """Return what the navigator ``name`` must be and is not; "" if there is nothing."""
    return _class_rule(Navigator, plugin)


def planner_rule(name: str, plugin: Any) -> str:
    """Return what the planner ``name`` must be and is not; "" if there is nothing."""
    return _class_rule(Planner, plugin)


def controller_rule(name: str, plugin: Any) -> str:
    """Return what the controller ``name`` must be and is not; "" if there is nothing."""
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
