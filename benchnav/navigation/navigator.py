"""The contract of every competitor: observation → command, for a batch of worlds.

A navigator is made once from its Config, `reset` starts some worlds of the batch,
and `act` answers for all worlds that it is shown. State belongs to a row (one
world), never to the call: a world's commands may not depend on which other worlds
share the call, nor on the order of its agents.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.configure import Spec
from benchnav.plugins import Source


class Need(StrEnum):
    """What a navigator cannot do without."""

    RAYS = "rays"
    NEIGHBOURS = "neighbours"
    EDGES = "edges"
    MAP = "map"


CommandKind = Literal["velocity", "twist"]


class PluginConfig(BaseModel):
    """Base of every plugin's parameters: frozen, unknown keys refused, units in the field text."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class Training:
    """What a navigator's training cost."""

    decisions: int  # of agents, in all attempts
    seconds: float  # on the machine that its card names


class Navigator(ABC):
    """Observation → command. A twist is (forward speed [m/s], turn rate [rad/s])."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig
    needs: ClassVar[frozenset[Need]] = frozenset()
    command: ClassVar[CommandKind] = "velocity"  # planar velocity [m/s] in the world frame

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def required(self) -> frozenset[Need]:
        """What this configured instance needs (a pair of parts needs what both need)."""
        return self.needs

    @property
    def uses_map(self) -> bool:
        """False where a map changes nothing that it answers: one run then stands for all tracks.

        It is then granted none.
        """
        return True

    @property
    def reproducible(self) -> bool:
        """False where a wall-clock budget decides what it answers."""
        return True

    @property
    def training(self) -> Training | None:
        """What it cost to train; None for what does not learn."""
        return None

    @property
    def fingerprint(self) -> str:
        """Of what it reads from files, weights say, beyond its Config and version."""
        return ""

    @property
    def parts(self) -> tuple[Source, ...]:
        """The other plugins that it is made of."""
        return ()

    @property
    def rehearsal(self) -> int:
        """How many rehearsals it asks for before each episode: a grant that is charged."""
        return 0

    @property
    def leader(self) -> Spec | None:
        """The navigator that drives the leaders in its rehearsals; None without rehearsals."""
        return None

    def unfit(self, sensing: Sensing) -> str:
        """Why it cannot drive agents that sense so, beyond what it needs; "" where it can."""
        return ""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:  # noqa: B027 - optional
        """Start the worlds ``rows`` (N,), told ``briefings`` (N,)."""

    def remarks(self, row: int) -> Sequence[str]:
        """What it has to tell of the world in ``row`` after the episode; it is kept with it.

        Short sentences, of what a reader of the results should know: why there is no path, say.
        """
        return ()

    @abstractmethod
    def act(self, observation: Observation) -> FloatArray:
        """(B, A, 2) commands; entries of inactive agents are ignored."""


@dataclass(frozen=True)
class AgentView:
    """One agent's slice of an observation."""

    time: float
    position: FloatArray  # (2,)
    heading: float
    velocity: FloatArray  # (2,)
    goal: FloatArray  # (2,)
    observation: Observation  # the batch it was taken from
    world: int  # its place in the batch
    agent: int

    @property
    def neighbours(self) -> list[tuple[FloatArray, FloatArray, float]]:
        """(position, velocity, radius) of each sensed neighbour, nearest first."""
        seen = self.observation.neighbours
        if seen is None:
            return []
        at = (self.world, self.agent)
        return [
            (seen.position[at][k], seen.velocity[at][k], float(seen.radius[at][k]))
            for k in range(int(seen.count[at]))
        ]


class AgentNavigator(Navigator):
    """For authors who think of one agent: implement `act_agent`; the batching is done here."""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        if not hasattr(self, "briefings"):
            self.briefings: dict[int, Briefing] = {}
        for row, briefing in zip(rows, briefings, strict=True):
            self.briefings[int(row)] = briefing
            for agent in range(len(briefing)):
                self.reset_agent(briefing, int(row), agent)

    def reset_agent(self, briefing: Briefing, row: int, agent: int) -> None:
        """Start one agent of world ``row``."""

    @abstractmethod
    def act_agent(self, view: AgentView, briefing: Briefing) -> FloatArray | Sequence[float]:
        """(2,) the command of one active agent."""

    def act(self, observation: Observation) -> FloatArray:
        command = np.zeros((*observation.active.shape, 2))
        for world, agent in np.argwhere(observation.active):
            at = (int(world), int(agent))
            view = AgentView(
                float(observation.time[world]), observation.position[at],
                float(observation.heading[at]), observation.velocity[at],
                observation.goal[at], observation, *at,
            )  # fmt: skip
            briefing = self.briefings[int(observation.rows[world])]
            command[at] = self.act_agent(view, briefing)
        return command
