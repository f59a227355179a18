"""The contract of every navigator: observation → command, for a batch of worlds.

A navigator is made once from its Config, `reset` starts some worlds of the batch,
and `act` returns the commands for all worlds of an observation. State belongs to a
row (one world), never to the call: a world's commands must not depend on the other
worlds of the call or on the order of its agents.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.agent_view import AgentView
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.configure import Spec
from benchnav.plugins import Source


class Need(StrEnum):
    """The inputs that a navigator requires."""

    RAYS = "rays"
    NEIGHBOURS = "neighbours"
    EDGES = "edges"
    MAP = "map"


CommandKind = Literal["velocity", "twist"]


class PluginConfig(BaseModel):
    """Base of every plugin's parameters: frozen, no unknown keys, units in the descriptions."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class Training:
    """The cost of a navigator's training."""

    decisions: int  # of agents, in all attempts
    seconds: float  # on the machine that its model card names


class Navigator(ABC):
    """Observation → command. A twist is (forward speed [m/s], turn rate [rad/s])."""

    Config: ClassVar[type[PluginConfig]] = PluginConfig
    needs: ClassVar[frozenset[Need]] = frozenset()

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def required(self) -> frozenset[Need]:
        """The needs of this configured instance (a pair has the needs of both parts)."""
        return self.needs

    @property
    def command(self) -> CommandKind:
        """The kind of commands of `act`: planar velocities [m/s] in the world frame, or twists.

        In the perception track `noisy`, velocities are in the odometry frame of the agent.
        A class may declare it: ``command = "twist"``.
        """
        return "velocity"

    @property
    def uses_map(self) -> bool:
        """Whether the map can affect commands.

        If False, one run is reused for all tracks, and no map is granted.
        """
        return True

    @property
    def reproducible(self) -> bool:
        """Whether equal inputs give equal commands; False if a wall-clock budget affects them."""
        return True

    @property
    def training(self) -> Training | None:
        """The cost of training; None for a navigator that does not learn."""
        return None

    @property
    def fingerprint(self) -> str:
        """The fingerprint of the files that it reads, such as weights; "" if it reads none."""
        return ""

    @property
    def parts(self) -> tuple[Source, ...]:
        """The other plugins that it consists of."""
        return ()

    @property
    def rehearsal(self) -> int:
        """The number of rehearsals that it requests before each episode; granted and charged."""
        return 0

    @property
    def leader(self) -> Spec | None:
        """The navigator that drives the leaders in its rehearsals; None without rehearsals."""
        return None

    def unfit(self, sensing: Sensing) -> str:
        """Return why it cannot use this sensing, beyond missing needs; "" if it can."""
        return ""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:  # noqa: B027 - optional
        """Start the worlds ``rows`` (N,) with their ``briefings`` (N,)."""

    def remarks(self, row: int) -> Sequence[str]:
        """Return remarks on the world in ``row`` after the episode, which are stored with it.

        Each is a short sentence for readers of the results, for example why there is no path.
        """
        return ()

    @property
    def has_own_map(self) -> bool:
        """Whether `own_map` returns maps; True if a class overrides it."""
        return type(self).own_map is not Navigator.own_map

    def own_map(self, row: int, agent: int) -> Map | None:
        """Return the map that an agent of the world in ``row`` made itself until now, or None.

        A replay shows it. It is the same object until it changes. The call must not affect
        commands.
        """
        return None

    @abstractmethod
    def act(self, observation: Observation) -> FloatArray:
        """Return the commands (B, A, 2); entries of inactive agents are ignored."""


class AgentNavigator(Navigator):
    """A navigator for one agent at a time: implement `act_agent`; this class does the batching."""

    @cached_property
    def briefings(self) -> dict[int, Briefing]:
        """The briefing of each row that was reset."""
        return {}

    @cached_property
    def _states(self) -> dict[int, list[Any]]:
        """The states of the agents of each row that was reset."""
        return {}

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self.briefings[row] = briefing
            self._states[row] = [
                self.reset_agent(briefing, row, agent) for agent in range(len(briefing))
            ]

    def reset_agent(self, briefing: Briefing, row: int, agent: int) -> Any:
        """Start one agent of the world ``row`` and return its state, an empty dict by default.

        `act_agent` gets this object as ``view.state`` in each decision of the episode, and may
        change it. No other agent and no other world sees it.
        """
        return {}

    @abstractmethod
    def act_agent(self, view: AgentView, briefing: Briefing) -> FloatArray | Sequence[float]:
        """Return the command (2,) of one active agent."""

    def act(self, observation: Observation) -> FloatArray:
        command = np.zeros((*observation.active.shape, 2))
        for world, agent in np.argwhere(observation.active).tolist():
            row = int(observation.rows[world])
            view = self._view(observation, world, agent, row)
            command[world, agent] = self.act_agent(view, self.briefings[row])
        return command

    def _view(self, observation: Observation, world: int, agent: int, row: int) -> AgentView:
        at = (world, agent)
        return AgentView(
            time=float(observation.time[world]), position=observation.position[at],
            heading=float(observation.heading[at]), velocity=observation.velocity[at],
            goal=observation.goal[at], row=row, agent=agent, state=self._states[row][agent],
            observation=observation, batch_index=world,
        )  # fmt: skip
