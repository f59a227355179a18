"""A navigator that combines any planner with any controller."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field, field_validator

from benchnav.arena.sensing import Sensing
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.sweep import clearance
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.controller import Controller
from benchnav.navigation.hierarchy.composition import NO_PLANNER
from benchnav.navigation.hierarchy.hierarchical_config import GuidedConfig, PartSpec, resolved
from benchnav.navigation.hierarchy.learned_map import way_is_free
from benchnav.navigation.hierarchy.mapping import Mapping
from benchnav.navigation.hierarchy.path_tracker import PathTracker
from benchnav.navigation.hierarchy.plan_log import PlanLog, checked_plan
from benchnav.navigation.hierarchy.replanning import Policies, Replan, Watch
from benchnav.navigation.hierarchy.retreat import Retreat
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import (
    CommandKind,
    DynamicsName,
    Navigator,
    Need,
    PluginConfig,
    Training,
)
from benchnav.navigation.observation import Observation
from benchnav.navigation.planner import UNSOLVED, Plan, Planner
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import CONTROLLERS, PLANNERS, Source

TOUCH = 1e-3  # [m] by which a path may come nearer than its disc's radius, because of rounding
LEAST_DISC = 0.5  # share of the agent's radius: the smallest disc to plan for
NO_MAP = Plan(UNSOLVED, False, reason="no map is granted")
CONTACT = 1e-5  # [m] from a mapped obstacle at which a disc still counts as overlapping it


class Hierarchical(Navigator):
    """Plans a path for each agent on its map, and follows the path.

    The map is the granted one. With ``mapping`` the agent corrects and extends it with its
    sensors; in the track `unknown` the agent starts with an empty map. If planning fails, the
    agent keeps its path; without a path its target is the goal. `remarks` report this with the
    reason; `plans` holds the last plans. ``PLANNER+CONTROLLER`` and
    ``mapping+PLANNER+CONTROLLER`` are names of such navigators
    (`benchnav.navigation.hierarchy.composition`).
    """

    class Config(GuidedConfig):
        """Parameters."""

        controller: PartSpec = Field(description="a controller: name or {type: name, …}")

        @field_validator("controller")
        @classmethod
        def _resolve_controller(cls, part: PartSpec) -> PartSpec:
            return resolved(CONTROLLERS, part)

    needs: ClassVar[frozenset[Need]] = frozenset({Need.MAP})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        c = self.config
        self.planner: Planner | None = None
        if c.planner != NO_PLANNER:
            self.planner = make(PLANNERS, c.planner, where="planner")
        self.controller: Controller = make(CONTROLLERS, self._controller(), where="controller")
        self.mapping = Mapping(c.mapping) if c.mapping is not None else None
        self.plans: dict[int, list[Plan]] = {}  # row → the last plan of each agent
        usual: Replan = "blocked" if self.mapping else "map-change"
        self._policies = Policies(usual if c.replan is None else c.replan)
        self._tracker = PathTracker(
            self.controller.lookahead if c.lookahead is None else c.lookahead,
            self.controller.cut if c.cut is None else c.cut,
        )
        self._logs: dict[int, PlanLog] = {}
        self._watch: dict[int, Watch] = {}
        self._retreats: dict[int, Retreat] = {}

    def _controller(self) -> PartSpec:
        part: PartSpec = self.config.controller
        return part

    @property
    def required(self) -> frozenset[Need]:
        if self.planner is None:
            return self.controller.required
        known = self.needs if self.mapping is None else self.mapping.needs
        return known | self.controller.required

    @property
    def command(self) -> CommandKind:
        return self.controller.command

    @property
    def drives(self) -> frozenset[DynamicsName]:
        return self.controller.drives

    @property
    def uses_map(self) -> bool:
        return self.planner is not None

    @property
    def reproducible(self) -> bool:
        return self.planner is None or self.planner.reproducible

    @property
    def training(self) -> Training | None:
        return self.controller.training

    @property
    def fingerprint(self) -> str:
        return self.controller.fingerprint

    @property
    def parts(self) -> tuple[Source, ...]:
        controller = CONTROLLERS.source(_name(self._controller()))
        if self.planner is None:
            return (controller,)
        return PLANNERS.source(_name(self.config.planner)), controller

    def unfit(self, sensing: Sensing) -> str:
        reason = self.controller.unfit(sensing)
        return reason if reason or self.mapping is None else self.mapping.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self.controller.reset(briefings, rows)
        if self.mapping is not None:
            self.mapping.reset(briefings, rows)
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self._tracker.reset(row, briefing.preferred_speed * briefing.dt)
            self._watch[row] = Watch(briefing)
            self._retreats[row] = Retreat(briefing.start)
            self.plans[row] = []
            self._logs[row] = PlanLog(len(briefing))
            for agent in range(len(briefing)):
                self._plan(row, agent, briefing.map, briefing.start[agent], 0.0)

    def remarks(self, row: int) -> Sequence[str]:
        if row not in self._logs:
            return ()
        return self._logs[row].remarks(adapts=self.controller.adapts_clearance)

    @property
    def has_own_map(self) -> bool:
        return self.mapping is not None

    def own_map(self, row: int, agent: int) -> Map | None:
        return None if self.mapping is None else self.mapping.map(row, agent)

    def act(self, observation: Observation) -> FloatArray:
        if self.mapping is not None:
            self.mapping.see(observation)
        if self.planner is not None and not self._policies.never:
            for world, row in enumerate(observation.rows.tolist()):
                count, time = len(self._watch[row].briefing), float(observation.time[world])
                place = observation.position[world, :count]
                active, map = observation.active[world, :count], observation.maps[world]
                for agent in np.flatnonzero(active & self._due(row, place, active, map, time)):
                    self._plan(row, int(agent), map, place[agent], time)
        return self.controller.steer(observation, self._tracker.guide(observation))

    def _due(
        self, row: int, place: FloatArray, active: BoolArray, map: Map | None, time: float
    ) -> BoolArray:
        """Return (A,), True for agents that plan again now; False if the plan would be the same."""
        watch, policies = self._watch[row], self._policies
        if map is None and self.mapping is None:
            return np.zeros(len(place), np.bool_)
        version = self._versions(row, map)
        changed: BoolArray = version != watch.version
        due = changed & policies.map_change
        if self.mapping is not None:  # its map may change at every decision
            due = due & self._ready(watch, time)
        if policies.blocked:
            for agent in np.flatnonzero(active & (version != watch.looked)):
                self._look(row, int(agent), map, int(version[agent]))
            due = due | (watch.blocked & self._ready(watch, time))
        due = due | (time - watch.planned >= policies.interval * (1.0 - 1e-9))
        if not self.config.give_way:
            waited = watch.waited(place, time, self.config.patience, 2.0)
            return due | (waited & (watch.solved | changed))
        waited = watch.waited(place, time, self.config.patience, 1.0)
        due = self._give_way(row, place, due, active & waited, time)
        again = waited & (watch.solved | changed) & ~self._retreats[row].going(time)
        return due | again

    def _give_way(
        self, row: int, place: FloatArray, due: BoolArray, stuck: BoolArray, time: float
    ) -> BoolArray:
        """Send some stuck agents back. Return (A,), True for agents that plan again now.

        An agent that goes back does not plan until its retreat ends.
        """
        retreat, watch = self._retreats[row], self._watch[row]
        retreat.note(place, time)
        ended = ~retreat.going(time) & np.isfinite(retreat.until)
        retreat.until[ended] = -np.inf
        for agent in np.flatnonzero(stuck & ~retreat.going(time)).tolist():
            rng = watch.streams[agent]
            if rng.random() < self.config.give_way:
                self._tracker.follow(row, agent, retreat.begin(agent, place[agent], time, rng))
        again: BoolArray = (due | ended) & ~retreat.going(time)
        return again

    def _ready(self, watch: Watch, time: float) -> BoolArray:
        """Return (A,), True for agents whose last plan is at least ``pause`` old."""
        ready: BoolArray = time - watch.planned >= self.config.pause * (1.0 - 1e-9)
        return ready

    def _look(self, row: int, agent: int, map: Map | None, version: int) -> None:
        """Check the rest of a path against the current map."""
        watch = self._watch[row]
        watch.looked[agent] = version
        if not watch.solved[agent]:
            watch.blocked[agent] |= version != watch.version[agent]
            return
        way, radius = self._tracker.rest(row, agent), float(watch.radius[agent]) - TOUCH
        watch.blocked[agent] |= not way_is_free(way, radius, self._capsules(row, agent, map))

    def _plan(self, row: int, agent: int, map: Map | None, start: FloatArray, time: float) -> None:
        watch, plans = self._watch[row], self.plans[row]
        if self.planner is None:
            return
        if map is None and self.mapping is None:
            self._logs[row].note(agent, NO_MAP)
            return
        plan, radius = self._query_planner(row, agent, map, start)
        if not plan.solved and self.mapping is not None and self.mapping.doubt(row, agent):
            plan, radius = self._query_planner(row, agent, map, start)
        plans[agent : agent + 1] = [plan]
        self._logs[row].note(agent, plan)
        watch.planned[agent], watch.blocked[agent] = time, False
        watch.version[agent] = watch.looked[agent] = self._versions(row, map)[agent]
        watch.solved[agent] = plan.solved
        if plan.solved:
            watch.radius[agent] = radius
            self._tracker.follow(row, agent, plan.path, plan.clearance)

    def _query_planner(
        self, row: int, agent: int, map: Map | None, start: FloatArray
    ) -> tuple[Plan, float]:
        """Return (plan, radius [m] of the disc that it is for)."""
        known = map if self.mapping is None else self.mapping.map(row, agent)
        assert self.planner is not None and known is not None  # noqa: S101, PT018 - see `_plan`
        briefing, radius = self._watch[row].briefing, self._disc(row, agent, start)
        rng = self._watch[row].streams[agent]
        goal, tolerance = briefing.goal[agent], briefing.goal_tolerance
        plan = self.planner.plan(known, start, goal, radius, tolerance, rng)
        return checked_plan(plan, self.planner), radius

    def _disc(self, row: int, agent: int, start: FloatArray) -> float:
        """Return the radius [m] to plan for: the agent's, or less if it overlaps its own map.

        It can overlap the octagon of a mapped disc without touching the disc.
        """
        radius = float(self._watch[row].briefing.radius[agent])
        if self.mapping is None:
            return radius
        x, y = start.tolist()
        room = clearance(x, y, self.mapping.capsules(row, agent)) - CONTACT
        return min(radius, max(room, LEAST_DISC * radius))

    def _versions(self, row: int, map: Map | None) -> IntArray:
        """Return (A,), the version of the map that each agent plans on."""
        count = len(self._watch[row].briefing)
        if self.mapping is not None:
            return self.mapping.versions(row, count)
        return np.full(count, 0 if map is None else map.revision)

    def _capsules(self, row: int, agent: int, map: Map | None) -> FloatArray:
        if self.mapping is not None:
            return self.mapping.capsules(row, agent)
        return np.zeros((0, 5)) if map is None else map.capsules


def _name(part: PartSpec) -> str:
    return part if isinstance(part, str) else str(part["type"])
