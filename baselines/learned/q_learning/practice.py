"""Training worlds of the table; each restarts if no agent is active in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arena import Afterwards, ContactRule, World
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode import Status
from benchnav.sensors.sense import RAYS, ray_angles, sense
from benchnav.world.simulation import Simulation

from .encoder import encode, pick_rays
from .learner import Learner, chosen
from .moves import MAX_TURN, twists

_ACTIVE, _ARRIVED, _ENDED = int(Status.ACTIVE), int(Status.ARRIVED), int(Status.ENDED)


@dataclass(frozen=True)
class Reward:
    """The terms of the reward, per decision."""

    arrival: float = 1.0
    hit: float = -3.0
    metre: float = 0.03  # [1/m] of approach to the goal
    decision: float = -0.004
    turning: float = -0.002  # at the full turn rate


class Practice:
    """B worlds in which the table drives every agent.

    Contacts must end an attempt and make the agent vanish: then a restart only has to reset agents,
    bodies and clocks.
    """

    def __init__(self, worlds: Sequence[World], reward: Reward) -> None:
        s = self.simulation = Simulation(worlds)
        self.reward = reward
        sensor, rules = worlds[0].sensing.rays, worlds[0].rules
        if sensor is None or rules.contact != ContactRule.END or rules.on_end != Afterwards.VANISH:
            raise ValueError("The worlds to train in must have rays, and a contact must end all.")
        self._fresh = s.agents.copy(), s.bodies.copy(), s.records.copy()
        self._pick = pick_rays(ray_angles(sensor))
        self._speed = s.agents["preferred_speed"].copy()
        self._turn = np.minimum(s.agents["max_turn_rate"], MAX_TURN)
        self._tolerance = np.full((s.B, s.A), worlds[0].rules.goal_tolerance)
        self._index = np.broadcast_to(np.arange(s.A), (s.B, s.A))
        self._twist = np.ones((s.B, s.A), np.bool_)

    def run(
        self, learner: Learner, decisions: int, explore: float, rate: float,
        rng: np.random.Generator,
    ) -> int:  # fmt: skip
        """Act and learn for ``decisions`` decisions. Return the number of transitions."""
        active, state, steps = self._active(), self._situations(), 0
        for _ in range(decisions):
            move = np.zeros(active.shape, np.int64)
            move[active] = chosen(learner.values, state[active], explore, rng)
            away = self._distance()
            command = twists(move, self._speed, self._turn)
            self.simulation.step(command, self._twist)
            reward = self._reward(away, command)
            still, after = self._active(), self._situations()
            learner.update(
                state[active], move[active], reward[active], after[active], ~still[active], rate
            )
            steps += int(active.sum())
            active, state = still, after
        return steps

    def restart(self, patience: int) -> None:
        """Restart worlds without an active agent, or after ``patience`` decisions."""
        s = self.simulation
        over = np.flatnonzero(~self._active().any(axis=1) | (s.steps_done >= patience))
        for live, fresh in zip((s.agents, s.bodies, s.records), self._fresh, strict=True):
            live[over] = fresh[over]

    def _active(self) -> BoolArray:
        s = self.simulation
        active: BoolArray = s.present & (s.status == _ACTIVE) & s.running[:, None]
        return active

    def _distance(self) -> FloatArray:
        way = self.simulation.goal - self.simulation.position
        distance: FloatArray = np.sqrt(way[..., 0] ** 2 + way[..., 1] ** 2)
        return distance

    def _reward(self, away: FloatArray, command: FloatArray) -> FloatArray:
        """Return the reward (B, A) of a decision that began ``away`` (B, A) [m] from the goals."""
        s, r = self.simulation, self.reward
        turned = np.abs(command[..., 1]) / self._turn
        reward = r.decision + r.turning * turned + r.metre * (away - self._distance())
        reward[s.status == _ARRIVED] += r.arrival
        reward[s.status == _ENDED] += r.hit
        total: FloatArray = reward
        return total

    def _situations(self) -> IntArray:
        s, active = self.simulation, self._active()
        rays, _, _ = sense(s, np.where(active, self._index, -1), frozenset({RAYS}))
        out = np.zeros(active.shape, np.int64)
        if rays is not None:
            encode(
                active, s.position, s.heading, s.goal, self._speed, self._tolerance, self._pick,
                rays.angle, rays.distance, rays.kind, rays.approach, out,
            )  # fmt: skip
        return out
