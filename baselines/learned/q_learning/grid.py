"""Q-learning over the cells of a known arena: the result is valid for that arena only."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.kernels import kernel_without_allocation
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
        place, aim = observation.position, observation.position.copy()
        speed, dt = np.zeros(place.shape[:2]), np.ones(place.shape[:2])
        for world, row in enumerate(observation.rows):
            state, map = self._rows[int(row)], observation.maps[world]
            agents = slice(len(state.briefing))
            if map is not None and map.revision != state.revision:
                active = np.flatnonzero(observation.active[world, agents])
                state.learn(map, place[world, agents], active)
            state.aim(place[world, agents], aim[world, agents])
            speed[world, agents] = state.briefing.preferred_speed
            dt[world, agents] = state.briefing.dt
        return approach(place, aim, speed, dt)


class _Row:
    """One world: the learned next cells of its agents, and their targets."""

    def __init__(self, briefing: Briefing, config: QLearningGrid.Config) -> None:
        self.briefing, self.config = briefing, config
        self.revision = -1
        self._reach = np.maximum(0.5 * briefing.preferred_speed * briefing.dt, 1e-3)  # (A,) [m]
        self._going = np.full(len(briefing), _GOAL)  # (A,) cell
        self._streams = agent_streams(briefing)
        self._centre = np.empty((0, 2))  # (N, 2) [m] of cells; equal for any clearance
        self._after = np.empty((len(briefing), 0), np.int64)  # (A, N) cell after each cell

    def learn(self, map: Map, place: FloatArray, agents: IntArray) -> None:
        """Learn again on ``map`` for agents at ``place`` (A, 2) [m]."""
        self.revision = map.revision
        self._going[agents] = _GOAL
        laid: dict[tuple[float, float], Cells] = {}
        for agent in agents.tolist():
            radius, wanted = float(self.briefing.radius[agent]), self.config.clearance
            for clearance in dict.fromkeys((wanted, 0.5 * wanted, 0.0)):
                key = (radius, clearance)
                if key not in laid:
                    laid[key] = self._laid(map, *key)
                if self._learn_agent(laid[key], place[agent], agent):
                    break

    def _laid(self, map: Map, radius: float, clearance: float) -> Cells:
        """Return the cells of a map; without agents on the way if its bounds are new."""
        cells = lay_cells(map, self.config.cell, radius, clearance)
        if not np.array_equal(cells.centre, self._centre):
            self._centre = cells.centre
            self._after = np.full((len(self.briefing), len(cells.centre)), _GOAL)
            self._going[:] = _GOAL
        return cells

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
        _, after = learn(cells, ends, goal, start, how, self._streams[agent])
        over = np.zeros(len(after), np.bool_)
        over[ends] = True
        if follow(after, over, start) < 0:
            return False
        self._after[agent], self._going[agent] = after, start
        return True

    def aim(self, place: FloatArray, out: FloatArray) -> None:
        """Set ``out`` (A, 2) [m] to centres of cells that lie ahead, or to goals."""
        out[:] = self.briefing.goal
        _pursue(place, self._centre, self._after, self._reach, self._going, out)


@kernel_without_allocation
def _pursue(
    place: FloatArray, centre: FloatArray, after: IntArray, reach: FloatArray, going: IntArray,
    aim: FloatArray,
) -> None:  # fmt: skip
    """Set ``aim`` (A, 2) to the centre of the cell ``going`` (A,), or of a next one if reached."""
    for agent in range(len(going)):
        for _ in range(3):
            cell = going[agent]
            if cell == _GOAL:
                break
            x, y = centre[cell, 0] - place[agent, 0], centre[cell, 1] - place[agent, 1]
            if x * x + y * y > reach[agent] * reach[agent]:
                aim[agent, 0], aim[agent, 1] = centre[cell, 0], centre[cell, 1]
                break
            going[agent] = after[agent, cell]
