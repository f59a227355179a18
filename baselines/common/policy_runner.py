"""What was learned, at work in many rows: as a navigator, or as a controller on a path."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller, Guide
from benchnav.navigation.navigator import CommandKind, Navigator, Need, Training
from benchnav.navigation.observation import Observation

from .waypoint import towards


class Pilot(ABC):
    """Drives agents to the goals of what it is shown, which may be waypoints."""

    @property
    @abstractmethod
    def needs(self) -> frozenset[Need]:
        """The sensors that it reads."""

    @property
    @abstractmethod
    def training(self) -> Training:
        """What it cost to learn."""

    @property
    @abstractmethod
    def fingerprint(self) -> str:
        """Of the file that holds what was learned."""

    def unfit(self, sensing: Sensing) -> str:
        """Why it cannot drive agents that sense so; "" where it can."""
        return ""

    @abstractmethod
    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Start the worlds ``rows`` (N,)."""

    @abstractmethod
    def tolerance(self, seen: Observation) -> FloatArray:
        """(B, A) [m] of the goals of the agents in sight."""

    @abstractmethod
    def twists(self, seen: Observation, tolerance: FloatArray) -> FloatArray:
        """(B, A, 2) forward speed [m/s] and turn rate [rad/s] towards the goals.

        Args:
            seen: one decision's view.
            tolerance: (B, A) [m] from a goal within which nothing behind it matters.
        """


class _Piloted:
    """What a piloted navigator and a piloted controller answer alike."""

    command: ClassVar[CommandKind] = "twist"
    pilot: Pilot

    @property
    def required(self) -> frozenset[Need]:
        return self.pilot.needs

    @property
    def training(self) -> Training:
        return self.pilot.training

    @property
    def fingerprint(self) -> str:
        return self.pilot.fingerprint

    def unfit(self, sensing: Sensing) -> str:
        return self.pilot.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.pilot.reset(briefings, rows)


class PilotedNavigator(_Piloted, Navigator):
    """A pilot on its way to the goals."""

    @property
    def uses_map(self) -> bool:
        return False

    def act(self, observation: Observation) -> FloatArray:
        return self.pilot.twists(observation, self.pilot.tolerance(observation))


class PilotedController(_Piloted, Controller):
    """A pilot that is shown the guide's targets as its goals (`.waypoint`)."""

    lookahead: ClassVar[float] = 3.0

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        tolerance = self.pilot.tolerance(observation)
        return self.pilot.twists(*towards(observation, guide, tolerance))
