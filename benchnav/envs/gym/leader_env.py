"""Gymnasium's Env: one agent of one world learns, a navigator drives the others."""

from typing import Any, ClassVar

import gymnasium
import numpy as np

from benchnav.envs.background_agents import Others
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.factory import Reward, drawn_index, make_batch, refuse_rendering
from benchnav.envs.gym.spaces import action_space, last_seen, observation_space, terms
from benchnav.envs.seeding import plain_seed
from benchnav.errors import UsageError
from benchnav.navigation.plugin.configure import Spec


class LeaderEnv(gymnasium.Env[Float32Array, Float32Array]):
    """An attempt is terminated on arriving or touching anything, truncated by time.

    Each attempt is by an agent drawn anew in a world drawn anew. Registered as
    ``benchnav/Leader-v0`` by `benchnav.envs.gym.registration`.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}  # type: ignore[misc]

    def __init__(
        self,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        others: Spec | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Draws the worlds.

        Args:
            scenario: a name or a YAML file; agents with a driver of its own do not learn.
            encoder: what the agent observes, one of `encoders.catalogue.ENCODERS`.
            split: train or validation.
            worlds: how many of the split.
            reward: weights that are not the defaults, see `RewardWeights`.
            others: the navigator of the other agents, by name or ``{"type": name, …}``; required.
            render_mode: None; nothing is drawn.

        Raises BenchnavError for a mistake in any of these.
        """
        refuse_rendering(render_mode)
        if others is None:
            raise UsageError(
                'others must name the navigator of the other agents: others="NAME".'
                " 'benchnav list navigators' shows all."
            )
        self.batch = make_batch(scenario, encoder, split, worlds, reward)
        self.observation_space = observation_space(self.batch.encoder)
        self.action_space = action_space()
        self.agent = 0
        self._others = Others(others, self.batch.simulation, self.batch.width - 1, "others")
        self._going = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start an attempt.

        Args:
            seed: from here on worlds, agents, and what other navigators draw, follow from it.
            options: ``world``, one of the pool, and ``agent``, one of the learning agents of
                that world, instead of what would be drawn.

        Returns:
            (D,) and an info that names the world and the agent, as the options do.
        """
        super().reset(seed=plain_seed(seed))
        others, drivers = self.np_random.spawn(2)
        self.batch.reseed(drivers)
        world = drawn_index(self.np_random, "world", options, self.batch.learnable)
        learners = np.flatnonzero(self.batch.simulation.pool[world].agents.evaluated)
        chosen = drawn_index(self.np_random, "agent", options, np.arange(len(learners)))
        self.agent = int(learners[chosen])
        seen = self.batch.reset(np.array([world]))
        self._others.start(np.zeros(1, np.int64), [learners[learners != self.agent]], [others])
        self._going = True
        return seen[0, self.agent].copy(), {"world": world, "agent": chosen}

    def step(self, action: Float32Array) -> tuple[Float32Array, float, bool, bool, dict[str, Any]]:
        """Decide. ``action`` (2,) in [-1, 1]: speed from 0 to the limit, turn rate.

        ``info`` holds the reward's ``terms`` before scaling and ``is_success``: it arrived,
        and touched nothing before. Raises UsageError where the attempt is over.
        """
        if not self._going:
            raise UsageError("An attempt must begin before it goes on: call reset() first.")
        at = (0, self.agent)
        everybody = np.zeros((1, self.batch.width, 2))
        everybody[at] = action
        step = self.batch.step(everybody, self._others.decide(self.batch.active))
        terminated, truncated = bool((step.arrived | step.touched)[at]), bool(step.timed_out[at])
        self._going = not (terminated or truncated)
        info = {
            "is_success": bool(step.arrived[at]),
            "terms": {name: float(term[at]) for name, term in terms(step).items()},
        }
        return last_seen(step)[at], float(step.reward[at]), terminated, truncated, info
