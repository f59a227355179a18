"""Q-learning over the cells of a known arena: the result is valid for that arena only."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    Map,
    Navigator,
    Need,
    Observation,
    PluginConfig,
    agent_streams,
)

from ...common.approach import approach
from .cells import Cells, lay_cells
from .grid_learner import Schooling, follow, learn

_GOAL = -1  # target instead of a cell


class QLearningGrid(Navigator):
    """Learns cell × move values to each goal before it starts, and follows them greedily.

    It moves from cell centre to cell centre and ignores movers. If the map's
    revision rises, it learns again; if the map stays stale, it does not.
    Without a path over the cells it heads straight for the goal.
    """

    class Config(PluginConfig):
        """Parameters."""

        cell: float = Field(0.25, gt=0, description="[m] side of a cell")
        clearance: float = Field(
            0.2, ge=0, description="[m] kept from obstacles; less if no path is found with it"
        )
        decisions: int = Field(100_000, ge=1, description="moves tried in learning, per agent")
        explore: float = Field(0.1, ge=0, le=1, description="share of random moves among these")
        rate: float = Field(1.0, gt=0, le=1, description="step size; 1, as moves are deterministic")

    needs: ClassVar[frozenset[Need]] = frozenset({Need.MAP})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._rows: dict[int, _Row] = {}

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            self._rows[int(row)] = state = _Row(briefing, self.config)
            if briefing.map is not None:
                all_agents = np.arange(len(briefing))
                state.learn(briefing.map, briefing.start, all_agents)

    def act(self, observation: Observation) -> FloatArray:
        command = np.zeros((*observation.active.shape, 2))
        for world, row in enumerate(observation.rows):
            state, map = self._rows[int(row)], observation.maps[world]
            count = len(state.briefing)
            place = observation.position[world, :count]
            if map is not None and map.revision != state.revision:
                state.learn(map, place, np.flatnonzero(observation.active[world, :count]))
            command[world, :count] = state.velocity(place)
        return command


class _Row:
    """One world: the learned values of its agents, and their targets."""

    def __init__(self, briefing: Briefing, config: QLearningGrid.Config) -> None:
        self.briefing, self.config = briefing, config
        self.revision = -1
        self.going = np.full(len(briefing), _GOAL)  # (A,) cell
        self._streams = agent_streams(briefing)
        self._policy: dict[int, tuple[Cells, IntArray]] = {}  # agent → cell after each cell

    def learn(self, map: Map, place: FloatArray, agents: IntArray) -> None:
        """Learn again on ``map`` for agents at ``place`` (A, 2) [m]."""
        self.revision = map.revision
        laid: dict[tuple[float, float], Cells] = {}
        for agent in agents.tolist():
            self.going[agent] = _GOAL
            self._policy.pop(agent, None)
            radius, wanted = float(self.briefing.radius[agent]), self.config.clearance
            for clearance in dict.fromkeys((wanted, 0.5 * wanted, 0.0)):
                key = (radius, clearance)
                if key not in laid:
                    laid[key] = lay_cells(map, self.config.cell, *key)
                if self._learn_agent(laid[key], place[agent], agent):
                    break

    def _learn_agent(self, cells: Cells, place: FloatArray, agent: int) -> bool:
        """Learn for one agent; return whether a path was found."""
        goal, tolerance = self.briefing.goal[agent], self.briefing.goal_tolerance
        ends = cells.joined(goal, max(1.5 * cells.side, tolerance))
        begin = cells.joined(place, max(3.0 * cells.side, float(self.briefing.radius[agent])))
        if not len(ends) or not len(begin):
            return False
        c = self.config
        how = Schooling(c.decisions, c.explore, c.rate)
        start = int(begin[0])
        _, best = learn(cells, ends, goal, start, how, self._streams[agent])
        over = np.zeros(len(best), np.bool_)
        over[ends] = True
        if follow(best, cells.after, over, start) < 0:
            return False
        after = cells.after[np.arange(len(best)), best]
        after[over] = _GOAL
        self._policy[agent], self.going[agent] = (cells, after), start
        return True

    def velocity(self, place: FloatArray) -> FloatArray:
        """Return velocities (A, 2) [m/s] towards target centres, or the next ones after arrival."""
        aim = self.briefing.goal.copy()
        speed, dt = self.briefing.preferred_speed, self.briefing.dt
        for agent, (cells, after) in self._policy.items():
            reach = max(0.5 * float(speed[agent]) * dt, 1e-3)
            for _ in range(3):
                cell = self.going[agent]
                if cell == _GOAL:
                    break
                aim[agent] = cells.centre[cell]
                offset = aim[agent] - place[agent]
                if offset @ offset > reach * reach:
                    break
                self.going[agent] = after[cell]
                aim[agent] = self.briefing.goal[agent]
        return approach(place, aim, speed, np.full(len(speed), dt))
