"""Any planner with any controller; itself a navigator."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.configure import make
from benchnav.navigation.controller import Controller
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Navigator, Need, PluginConfig
from benchnav.navigation.observation import Observation
from benchnav.navigation.path_tracker import PathTracker
from benchnav.navigation.planner import Plan, Planner
from benchnav.navigation.streams import agent_streams
from benchnav.plugins import CONTROLLERS, PLANNERS

from .orca.avoidance import OrcaConfig

PartSpec = str | dict[str, Any]


class Every(PluginConfig):
    """Plan again at fixed intervals."""

    every: float = Field(gt=0, description="[s] between plans")


class GuidedConfig(PluginConfig):
    """Parameters that every pair of planner and controller has."""

    planner: PartSpec = Field("ompl.rrt-connect", description="a planner: name or {type: name, …}")
    replan: Literal["never", "map-change"] | Every = Field(
        "map-change",
        description="when to plan again: never, when the map's revision rises (map-change), or then"
        " and at intervals ({every: seconds})",
    )
    patience: float = Field(
        4.0,
        gt=0,
        description="[s] without getting a radius away, after which an agent that may"
        " plan again does (twice as long if that does not help, and so on): others can push it"
        " round a corner that its path does not turn",
    )
    lookahead: float = Field(1.0, gt=0, description="[m] of path between agent and target, at most")
    cut: float = Field(0.03, gt=0, description="[m] by which corners of the path may be missed")


class Hierarchical(Navigator):
    """Plans a path for each agent on the map that it is given, and follows it.

    Where planning fails, the agent keeps the path that it has; without one its
    target is the goal. `plans` says what planning answered.
    """

    class Config(GuidedConfig):
        """Parameters."""

        controller: PartSpec = Field(
            "path-following", description="a controller: name or {type: name, …}"
        )

    needs: ClassVar[frozenset[Need]] = frozenset({Need.MAP})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.planner: Planner = make(PLANNERS, self.config.planner, where="planner")
        self.controller: Controller = make(CONTROLLERS, self._controller(), where="controller")
        vars(self)["command"] = self.controller.command  # declared for the class, known here
        self.plans: dict[int, list[Plan]] = {}  # row → the last plan of each agent
        self._tracker = PathTracker(self.config.lookahead, self.config.cut)
        self._state: dict[int, _Row] = {}

    def _controller(self) -> PartSpec:
        part: PartSpec = self.config.controller
        return part

    @property
    def required(self) -> frozenset[Need]:
        return self.needs | self.controller.needs

    @property
    def reproducible(self) -> bool:
        return self.planner.reproducible

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.controller.reset(briefings, rows)
        for row, briefing in zip(rows, briefings, strict=True):
            self._tracker.reset(int(row), briefing.preferred_speed * briefing.dt)
            self._state[int(row)] = _Row(briefing)
            self.plans[int(row)] = []
            for agent in range(len(briefing)):
                self._plan(int(row), agent, briefing.map, briefing.start[agent])

    def act(self, observation: Observation) -> FloatArray:
        for world, row in enumerate(observation.rows):
            state, map = self._state[int(row)], observation.maps[world]
            if map is None or self.config.replan == "never":
                continue
            place, time = observation.position[world], float(observation.time[world])
            waited = state.waited(place, time, self.config.patience)
            due = self._is_due(state, map, time)
            if due:
                state.revision, state.planned = map.revision, time
            for agent in np.flatnonzero(observation.active[world] & (waited | due)):
                if due or self.plans[int(row)][agent].solved:  # else the answer would be the same
                    self._plan(int(row), int(agent), map, place[agent])
        return self.controller.steer(observation, self._tracker.guide(observation))

    def _is_due(self, state: "_Row", map: Map, time: float) -> bool:
        when = self.config.replan
        if map.revision != state.revision:
            return True
        return isinstance(when, Every) and time - state.planned >= when.every * (1.0 - 1e-9)

    def _plan(self, row: int, agent: int, map: Map | None, start: FloatArray) -> None:
        state, plans = self._state[row], self.plans[row]
        told = state.briefing
        if map is None:
            return
        plan = self.planner.plan(
            map, start, told.goal[agent], float(told.radius[agent]), told.goal_tolerance,
            state.streams[agent],
        )  # fmt: skip
        plans[agent : agent + 1] = [plan]
        if plan.solved:
            self._tracker.follow(row, agent, plan.path)


class _Row:
    """What is kept of one world."""

    def __init__(self, briefing: Briefing) -> None:
        self.briefing = briefing
        self.streams = agent_streams(briefing)
        self.revision = 0 if briefing.map is None else briefing.map.revision
        self.planned = 0.0  # [s]
        self._place = briefing.start.copy()  # (A, 2) [m] within a radius of which it has been
        self._since = np.zeros(len(briefing))  # (A,) [s] when it came there, or last asked
        self._tries = np.zeros(len(briefing), np.int64)  # (A,) how often it asked there

    def waited(self, position: FloatArray, time: float, patience: float) -> BoolArray:
        """(A,) True where an agent has been in one place for so long [s], then twice as long, …"""
        count = len(self._since)
        offset = position[:count] - self._place
        left = np.sum(offset * offset, axis=1) > self.briefing.radius**2
        enough = patience * 2.0**self._tries * (1.0 - 1e-9)
        long: BoolArray = ~left & (time - self._since >= enough)
        self._tries = np.where(left, 0, self._tries + long)
        self._place[left] = position[:count][left]
        self._since[left | long] = time
        result = np.zeros(len(position), np.bool_)
        result[:count] = long
        return result


class OmplPure(Hierarchical):
    """An OMPL planner, and path following alone: nothing that moves is avoided."""

    class Config(GuidedConfig):
        """Parameters."""

    def _controller(self) -> PartSpec:
        return "path-following"


class OmplOrca(Hierarchical):
    """An OMPL planner, and optimal reciprocal collision avoidance along its path."""

    class Config(GuidedConfig):
        """Parameters."""

        orca: OrcaConfig = Field(OrcaConfig(), description="parameters of the controller")
        lookahead: float = Field(
            1.0, gt=0, description="[m] of path between agent and target, at most"
        )
        cut: float = Field(0.1, gt=0, description="[m] by which corners of the path may be missed")

    def _controller(self) -> PartSpec:
        return {"type": "orca", **self.config.orca.model_dump()}
