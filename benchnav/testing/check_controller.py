"""The checks of a controller: the checks of a navigator, on a straight path to its goal."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller, Guide
from benchnav.navigation.navigator import CommandKind, DynamicsName, Navigator, Need
from benchnav.navigation.observation import Observation
from benchnav.plugins import CONTROLLERS
from benchnav.testing.check_navigator import check_navigator
from benchnav.testing.requirement import Subject, maker, require, require_config

LOOKAHEAD = 1.0  # [m]


def check_controller(controller: Subject, sensing: Sensing | None = None) -> None:
    """Check that a controller keeps the contract of controllers.

    Args:
        controller: a registered name, ``{type: name, …parameters}``, a class, or any
            function that makes a fresh instance.
        sensing: the sensors of the worlds of the checks, as in `check_navigator`.

    Raises:
        AssertionError: the controller breaks the contract; the message names the rule.
    """
    make = maker(CONTROLLERS, controller)
    instance = make()
    name = type(instance).__name__
    require(isinstance(instance, Controller), f"{name} must derive from Controller.")
    require_config(instance)
    named = type(name, (_Guided,), {})  # so that messages name the controller
    check_navigator(lambda: named(make()), sensing)


class _Guided(Navigator):
    """A navigator that runs a controller on straight paths; some agents have no path."""

    def __init__(self, controller: Controller) -> None:
        super().__init__()
        self.controller = controller

    @property
    def required(self) -> frozenset[Need]:
        return self.controller.required

    @property
    def command(self) -> CommandKind:
        return self.controller.command

    @property
    def drives(self) -> frozenset[DynamicsName]:
        return self.controller.drives

    def unfit(self, sensing: Sensing) -> str:
        return self.controller.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.controller.reset(briefings, rows)

    def act(self, observation: Observation) -> FloatArray:
        return self.controller.steer(observation, straight(observation))


def straight(observation: Observation) -> Guide:
    """Return a guide of straight paths; agents whose goal has a smaller x have no path."""
    way = observation.goal - observation.position
    remaining = np.sqrt(np.sum(way * way, axis=2))
    share = np.minimum(LOOKAHEAD / np.maximum(remaining, 1e-9), 1.0)[..., None]
    has_path = way[..., 0] >= 0.0
    target = np.where(has_path[..., None], observation.position + share * way, observation.goal)
    return Guide(target, remaining, has_path)
