"""The decision process of every agent of a batch of worlds; all environments are views of it.

A slot is one agent of one row; agents that the scenario's own drivers move have no attempts.
When an attempt is over (the agent arrived, touched something, or time ran out), the slot is
idle, without observation and reward, until the last attempt of the row is over. Then the row
starts again with the next world of the pool, unless the batch has no autoreset.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Protocol

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, ContactRule, World
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.envs.autoreset import AutoresetSimulation
from benchnav.envs.background_agents import BackgroundCommands, BackgroundNavigator
from benchnav.envs.collision_probability import collision_probability
from benchnav.envs.decision import judge, scale_actions
from benchnav.envs.encoders.encoder import Bodies, Encoder, Float32Array
from benchnav.envs.reward import RewardTerms, RewardWeights, reward_of
from benchnav.episode.episode import Status
from benchnav.errors import UsageError
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation
from benchnav.navigation.observe import observe
from benchnav.navigation.plugin.configure import Spec
from benchnav.sensors.noise.noisy_senses import NoisySenses


@dataclass(frozen=True, eq=False)
class Transition:
    """The results of one decision, (B, A) each; entries of idle slots have no meaning."""

    acted: BoolArray  # attempts that were active before the decision
    reward: FloatArray  # scaled
    terms: RewardTerms  # unscaled
    arrived: BoolArray  # the attempt ended at the goal, without a contact
    touched: BoolArray  # the attempt ended in a contact
    timed_out: BoolArray  # the attempt ended at the horizon
    restarted: BoolArray  # the observation is the first of another world
    observation: Float32Array  # (B, A, D) after restarts; zero for idle slots
    final: Float32Array  # (B, A, D) before restarts

    @property
    def over(self) -> BoolArray:
        """(B, A) attempts that ended."""
        return self.arrived | self.touched | self.timed_out


class Autoreset(Enum):
    """When a row starts again after its last attempt, with the names of Gymnasium."""

    DISABLED = "Disabled"  # only with `reset`: the row still shows the world of its last attempt
    SAME_STEP = "SameStep"  # in the step in which the last attempt ends
    NEXT_STEP = "NextStep"  # in the step after it, whose actions for the row are ignored


Correction = Callable[[Observation, Bodies, FloatArray, FloatArray], FloatArray]
"""(observation, bodies, twists (B, A, 2), goal tolerance (B, A) [m]) → twists."""


class Memory(Protocol):
    """A memory of past readings: adds objects to observations that are not perceived now."""

    def forget(self, row: int, agents: int, dt: float) -> None:
        """Forget all in ``row``, whose world has ``agents`` and decisions every ``dt`` [s]."""

    def recall(self, observation: Observation) -> Observation:
        """Add remembered objects to what active agents observe; store what they observe now."""


class AgentBatch:
    """B rows of worlds that share clock, rules and sensing, drawn from a pool in random order."""

    def __init__(
        self,
        pool: Sequence[World],
        rows: int,
        encoder: Encoder,
        weights: RewardWeights,
        rng: np.random.Generator,
        correct: Correction | None = None,
        drivers: Sequence[Spec] = (),
        *,
        autoreset: Autoreset = Autoreset.SAME_STEP,
        noise: Noise | None = None,
        reverse: bool = True,
        memory: Memory | None = None,
    ) -> None:
        """Prepare the batch. No world is drawn before `reset`.

        Args:
            pool: worlds that share clock, rules and sensing.
            rows: B.
            encoder: encodes the observations of the learners.
            weights: of the reward.
            rng: for the order of worlds, and for the drivers.
            correct: changes the learners' commands before their execution; its observation
                has the needs of the encoder, and neighbours.
            drivers: navigators of the teams that are not evaluated.
            autoreset: when a row starts again.
            noise: of the senses of the learners, drawn anew for each start of a row; None: they
                perceive without error.
            reverse: whether the speeds of actions begin at full speed backwards for bodies that
                can reverse, instead of at 0.
            memory: of the learners, for an encoder with neighbours and edges; neither the reward
                nor ``correct`` depends on it.

        Raises UsageError if no world of the pool has an agent that learns.
        """
        self.learnable = np.flatnonzero([world.agents.evaluated.any() for world in pool])
        if not len(self.learnable):
            raise UsageError(
                f"At least one agent must learn. In all {len(pool)} worlds of the pool every"
                " agent has a driver: leave out `driver` of the team that must learn."
            )
        self.encoder, self.weights, self.correct = encoder, weights, correct
        self._autoreset = autoreset
        self.simulation = AutoresetSimulation([_strict(world) for world in pool], rows)
        self._rng = rng
        self._queue = np.zeros(0, np.int64)
        self._encoded_needs = frozenset(map(str, encoder.needs))
        self._needs = self._encoded_needs | {str(Need.NEIGHBOURS)}
        s = self.simulation
        self._movers = any(
            body.solid.kind == Kind.DYNAMIC for world in pool for body in world.bodies
        )
        self._twist = np.ones((s.B, s.A), np.bool_)
        self._drivers = [
            BackgroundNavigator(
                spec, s, max(int((w.agents.driver == k).sum()) for w in pool), "driver"
            )
            for k, spec in enumerate(drivers, 1)
        ]
        limits = (s.agents[name] for name in ("radius", "max_speed", "max_turn_rate"))
        self._bodies = Bodies(*limits)  # views, which follow the restarts of rows
        self.active = np.zeros((s.B, s.A), np.bool_)
        self._slots = np.tile(np.arange(s.A), (s.B, 1))  # (B, A) all agents
        self._senses = NoisySenses(s, self._slots, noise) if noise is not None else None
        self._reverse, self._memory = reverse, memory
        self.only: BoolArray | None = None  # (B, A) agents that learn now; None: all

    @property
    def rows(self) -> int:
        """B."""
        return self.simulation.B

    @property
    def width(self) -> int:
        """A, the slots of a row."""
        return self.simulation.A

    def reset(self, worlds: IntArray | None = None) -> Float32Array:
        """Start every row, with the worlds (B,) of the pool or with the next ones."""
        rows = np.arange(self.rows)
        self._start(rows, self._next(len(rows)) if worlds is None else worlds)
        return self._encoded(self._observe(self.active))

    def reseed(self, rng: np.random.Generator) -> None:
        """Draw the order of all further worlds from ``rng``."""
        self._rng, self._queue = rng, np.zeros(0, np.int64)

    def step(self, action: AnyArray, background: BackgroundCommands | None = None) -> Transition:
        """Execute a decision. ``action`` (B, A, 2) in [-1, 1]: speed from least to most, turn rate.

        The least speed is 0, or full speed backwards (see ``reverse``). Active slots in
        ``background`` execute its commands instead of their action.
        """
        s, acted = self.simulation, self.active
        shape = acted.shape
        command, twist = np.empty((*shape, 2)), self._twist
        away, nearer, turned = np.empty(shape), np.empty(shape), np.empty(shape)
        scale_actions(
            np.ascontiguousarray(action, np.float64), acted, self._reverse, s.agents, s.limits,
            command, away,
        )  # fmt: skip
        if self.correct is not None:
            tolerance = np.repeat(s.records["tolerance"][:, None], s.A, axis=1)
            command = self.correct(self._observe(acted), self._bodies, command, tolerance)
            command[~acted] = 0.0
        for other in (*([] if background is None else [background]), *self._driven()):
            np.copyto(command, other.command, where=other.mask[..., None])
            if not other.twist:
                twist = twist & ~other.mask
        executed = s.step(command, twist)
        arrived, touched, timed_out, self.active = (np.empty(shape, np.bool_) for _ in range(4))
        judge(
            acted, away, executed, s.records, s.agents, arrived, touched, timed_out, self.active,
            nearer, turned,
        )  # fmt: skip
        seen = self._observe(self._observing(timed_out))
        terms, reward = reward_of(
            self.weights, acted=acted, arrived=arrived, nearer=nearer, contacts=s.begun(),
            probability=self._probability(seen), turned=turned,
        )  # fmt: skip
        final = self._encoded(seen)
        done = self._to_restart(acted)
        restarted = np.zeros(shape, np.bool_)
        observation = final.copy()
        if len(done):
            self._start(done, self._next(len(done)))
            restarted[done] = self.active[done]
            fresh = self._encoded(self._observe(restarted))
            observation = np.where(restarted[..., None], fresh, final)
        observation[~self.active] = 0.0
        return Transition(
            acted, reward, terms, arrived, touched, timed_out, restarted, observation, final
        )

    def _to_restart(self, acted: BoolArray) -> IntArray:
        """Return the rows that start again; ``acted`` (B, A) had an attempt before the decision."""
        if self._autoreset is Autoreset.DISABLED:
            return np.zeros(0, np.int64)
        before = self._autoreset is Autoreset.NEXT_STEP
        return np.flatnonzero(~(acted if before else self.active).any(1))

    def _observing(self, timed_out: BoolArray) -> BoolArray:
        """Return the agents (B, A) whose observation counts after a step."""
        going = self.active | timed_out
        ages = self._senses is not None or self._memory is not None  # each reading counts
        return going if self.only is None or ages else going & self.only

    def _probability(self, seen: Observation) -> FloatArray:
        """Return the probability (B, A) of a collision with a mover."""
        if seen.neighbours is None:  # there are no movers
            return np.zeros(self.active.shape)
        return collision_probability(
            seen.position, seen.velocity, self._bodies.radius, seen.neighbours
        )

    def _start(self, rows: IntArray, worlds: IntArray) -> None:
        self.simulation.restart(rows, worlds)
        s = self.simulation
        if self._senses is not None:
            keys = self._rng.integers(0, 2**64, (len(rows), 2), np.uint64)
            self._senses.begin(rows, keys)
        self.active[rows] = s.present[rows] & s.agents["evaluated"][rows]
        if self._memory is not None:
            for row in rows:
                self._memory.forget(int(row), s.A, s.pool[0].clock.dt)
        for k, driver in enumerate(self._drivers, 1):
            mine = [np.flatnonzero(s.pool[w].agents.driver == k) for w in worlds]
            driver.start(rows, mine, self._rng.spawn(len(rows)))

    def _driven(self) -> list[BackgroundCommands]:
        if not self._drivers:
            return []
        s = self.simulation
        acting = s.present & (s.status == int(Status.ACTIVE)) & ~s.agents["evaluated"]
        return [driver.decide(acting) for driver in self._drivers]

    def _next(self, count: int) -> IntArray:
        """Return the next worlds, from repeated random orders of all worlds with learners."""
        while len(self._queue) < count:
            again = self._rng.permutation(self.learnable)
            self._queue = np.concatenate([self._queue, again])
        taken, self._queue = self._queue[:count], self._queue[count:]
        return taken

    def _observe(self, active: BoolArray) -> Observation:
        s = self.simulation
        return observe(s, self._slots, active, self._needed, (None,) * s.B, self._senses)

    @property
    def _needed(self) -> frozenset[str]:
        """The sensors that encoder, reward and correction need in these worlds."""
        return self._needs if self._movers or self.correct is not None else self._encoded_needs

    def _encoded(self, seen: Observation) -> Float32Array:
        if self._memory is not None:
            seen = self._memory.recall(seen)
        return self.encoder.encode(seen, self._bodies)


def _strict(world: World) -> World:
    """Return the world with attempts that end at a contact, because success allows none."""
    rules = replace(world.rules, contact=ContactRule.END, on_end=Afterwards.VANISH)
    return replace(world, rules=rules)
