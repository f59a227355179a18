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
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.agent_view import AgentView
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

    def __init__(self, config: PluginConfig | None = None) -> None:
        self.config: Any = config if config is not None else self.Config()

    @property
    def required(self) -> frozenset[Need]:
        """What this configured instance needs (a pair of parts needs what both need)."""
        return self.needs

    @property
    def command(self) -> CommandKind:
        """What `act` returns: planar velocities [m/s] in the world frame, or twists.

        A class may declare it: ``command = "twist"``.
        """
        return "velocity"

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


class AgentNavigator(Navigator):
    """For authors who think of one agent: implement `act_agent`; the batching is done here."""

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
