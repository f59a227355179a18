"""Who drives the agents that do not learn: any navigator, in the first row of a batch."""

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.envs.agent_batch import AgentBatch, Instead
from benchnav.errors import NavigatorError
from benchnav.navigation.briefing import brief
from benchnav.navigation.configure import Spec, make, split
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.observation import Observation
from benchnav.navigation.tracks import granted_map
from benchnav.plugins import NAVIGATORS
from benchnav.runner.answer import CallFailed, checked
from benchnav.sensors.sense import sense


class Others:
    """A navigator that drives everybody but one; it has the map, as a scenario's drivers do."""

    def __init__(self, spec: Spec, batch: AgentBatch) -> None:
        """Raises what `benchnav.navigation.configure.make` raises."""
        self.name = split(NAVIGATORS, spec)[0]
        self._navigator: Navigator = make(NAVIGATORS, spec)
        self._batch = batch
        self._mine: IntArray = np.zeros(0, np.int64)
        self._map: Map | None = None

    def start(self, learner: int, rng: np.random.Generator) -> None:
        """Brief the navigator for everybody but the agent ``learner`` of the world that began."""
        world = self._batch.simulation.worlds[0]
        everybody = np.arange(len(world.agents))
        self._mine = everybody[everybody != learner]
        self._map = granted_map(world, "known")
        if len(self._mine):
            clock = world.clock
            briefing = brief(
                world.agents, self._mine, dt=clock.dt, horizon=clock.horizon,
                goal_tolerance=world.rules.goal_tolerance, decision_budget=clock.decision_budget,
                map=self._map, rng=rng,
            )  # fmt: skip
            self._navigator.reset([briefing], np.zeros(1, np.int64))

    def decide(self) -> Instead:
        """What they do now.

        Raises NavigatorError where the navigator answers what is no command.
        """
        batch, mine = self._batch, self._mine
        command = np.zeros((batch.rows, batch.width, 2))
        who = np.zeros((batch.rows, batch.width), np.bool_)
        who[0, mine] = batch.active[0, mine]
        if who.any():
            seen = self._observe()
            try:
                command[0, mine] = checked(self._navigator.act(seen), seen.active)[0]
            except CallFailed as failed:
                raise NavigatorError(f"others={self.name!r}: {failed.reason}.") from None
        return Instead(who, command, self._navigator.command == "twist")

    def _observe(self) -> Observation:
        s, mine = self._batch.simulation, self._mine
        active = self._batch.active[:1, mine]
        needs = frozenset(map(str, self._navigator.required))
        rays, neighbours, edges = sense(s, np.where(active, mine, -1), needs)
        self._renew_map()

        def own(array: FloatArray) -> FloatArray:
            return array[:1, mine].copy()

        return Observation(
            np.zeros(1, np.int64), s.steps_done[:1] * s.records["dt"][:1], active.copy(),
            own(s.position), own(s.heading), own(s.velocity), own(s.goal), (self._map,),
            rays, neighbours, edges,
        )  # fmt: skip

    def _renew_map(self) -> None:
        s = self._batch.simulation
        revision = int(s.revision[0])
        if self._map is not None and self._map.revision != revision:
            self._map = granted_map(s.worlds[0], "known", s.body_position[0].copy(), revision)
