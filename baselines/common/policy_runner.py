"""A learned policy that drives many rows: as a navigator, or as a controller on a path."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from benchnav.arena import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    CommandKind,
    Controller,
    DynamicsName,
    Guide,
    Navigator,
    Need,
    Observation,
    Training,
)

from .waypoint import towards

TURN_ON_THE_SPOT: frozenset[DynamicsName] = frozenset(
    {"holonomic", "unicycle", "differential-drive"}
)
"""The dynamics of bodies that can turn on the spot, as the policies do that learned on unicycles.

Wheels and limits of acceleration delay their twists, but do not change their meaning.
"""


class Pilot(ABC):
    """Drives agents to the goals in its observation, which may be waypoints."""

    @property
    @abstractmethod
    def needs(self) -> frozenset[Need]:
        """The sensors that it needs."""

    @property
    @abstractmethod
    def training(self) -> Training | None:
        """The cost of its training; None if it is unknown."""

    @property
    @abstractmethod
    def fingerprint(self) -> str:
        """The digest of the file with the learned parameters."""

    def unfit(self, sensing: Sensing) -> str:
        """Return why it cannot drive agents with these sensors; "" if it can."""
        return ""

    @abstractmethod
    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Start the worlds ``rows`` (N,)."""

    @abstractmethod
    def tolerance(self, observation: Observation) -> FloatArray:
        """Return the goal tolerance (B, A) [m] of the agents in the observation."""

    @abstractmethod
    def twists(self, observation: Observation, tolerance: FloatArray) -> FloatArray:
        """Return forward speed [m/s] and turn rate [rad/s] (B, A, 2) towards the goals.

        Args:
            observation: of one decision.
            tolerance: (B, A) [m] from a goal within which obstacles behind it do not matter.
        """


class _Piloted:
    """The common part of a navigator and a controller with a pilot."""

    command: ClassVar[CommandKind] = "twist"
    drives: ClassVar[frozenset[DynamicsName]] = TURN_ON_THE_SPOT
    pilot: Pilot

    @property
    def required(self) -> frozenset[Need]:
        return self.pilot.needs

    @property
    def training(self) -> Training | None:
        return self.pilot.training

    @property
    def fingerprint(self) -> str:
        return self.pilot.fingerprint

    def unfit(self, sensing: Sensing) -> str:
        return self.pilot.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.pilot.reset(briefings, rows)


class PilotedNavigator(_Piloted, Navigator):
    """A pilot that drives to the goals."""

    @property
    def uses_map(self) -> bool:
        return False

    def act(self, observation: Observation) -> FloatArray:
        return self.pilot.twists(observation, self.pilot.tolerance(observation))


class PilotedController(_Piloted, Controller):
    """A pilot with the guide's targets as its goals (`.waypoint`)."""

    lookahead: ClassVar[float] = 3.0

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        tolerance = self.pilot.tolerance(observation)
        return self.pilot.twists(*towards(observation, guide, tolerance))
