"""Gymnasium's VectorEnv: every agent of every row learns, each a sub-environment."""

from typing import Any, ClassVar

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from benchnav.arrays import BoolArray, FloatArray
from benchnav.envs.agent_batch import Transition
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.making import Reward, make_batch, refuse_rendering
from benchnav.envs.spaces import action_space, last_seen, observation_space, terms
from benchnav.errors import UsageError

Stepped = tuple[Float32Array, FloatArray, BoolArray, BoolArray, dict[str, Any]]


class LeaderVectorEnv(VectorEnv[Float32Array, Float32Array, Any]):
    """Slots of a batch, row by row. Resets within the step that ends an attempt.

    Whose attempt is over before those of the other agents of its row idles until the row
    starts again: it observes zeros and is paid nothing, and this idle stretch counts as an
    attempt of its own, which terminates when the row starts again. ``info["idle"]`` (N,)
    says who idles now, ``info["acted"]`` (N,) whose last decision was real: a learner
    leaves the others out.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": [],
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        num_envs: int = 4,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        others: None = None,
        render_mode: str | None = None,
    ) -> None:
        """Draws the worlds. The parameters are those of `LeaderEnv`, but two.

        ``num_envs`` is N = B A, a multiple of the agents of a world; ``others`` must be None,
        since nobody is left to be driven by somebody else.

        Raises BenchnavError for a mistake in any of these.
        """
        refuse_rendering(render_mode)
        if others is not None:
            raise UsageError(
                "Every agent learns here: `others` must be None. Got"
                f" {others!r} instead; vectorization_mode='sync' has others."
            )
        self.batch = make_batch(scenario, encoder, split, worlds, reward, num_envs)
        self.num_envs, self._begun = num_envs, False
        self.single_observation_space = observation_space(self.batch.encoder)
        self.single_action_space = action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start every row. From a seed on, the order of worlds follows from it."""
        super().reset(seed=seed)
        if seed is not None or not self._begun:
            self.batch.reseed(self.np_random.spawn(1)[0])
        self._begun = True
        seen = self._flat(self.batch.reset())
        seen[self._idle()] = 0.0
        return seen, self._told({"idle": self._idle()}, np.ones(self.num_envs, np.bool_))

    def step(self, actions: Float32Array) -> Stepped:
        """Decide. ``actions`` (N, 2) in [-1, 1]; those of idle slots are ignored."""
        batch = self.batch
        step = batch.step(np.asarray(actions, np.float64).reshape(batch.rows, batch.width, 2))
        over = step.arrived | step.touched | (step.restarted & ~step.acted)
        truncated = step.timed_out.reshape(-1)
        reward: FloatArray = step.reward.reshape(-1)
        seen = self._flat(step.observation)
        return seen, reward, over.reshape(-1), truncated, self._info(step)

    def _info(self, step: Transition) -> dict[str, Any]:
        acted, over = step.acted.reshape(-1), step.over.reshape(-1)
        done = over | (step.restarted & ~step.acted).reshape(-1)
        named = {name: term.reshape(-1) for name, term in terms(step).items()}
        always = {"idle": self._idle(), "acted": acted}
        info = self._told(always, np.ones(self.num_envs, np.bool_))
        info |= self._told({"terms": self._told(named, acted)}, acted)
        if done.any():
            final = np.full(self.num_envs, None, dtype=object)
            last = self._flat(last_seen(step))
            for slot in np.flatnonzero(done):
                final[slot] = last[slot]
            ended = self._told({"is_success": step.arrived.reshape(-1)}, over)
            info |= self._told({"final_obs": final, "final_info": ended}, done)
        return info

    def _idle(self) -> BoolArray:
        return ~self.batch.active.reshape(-1)

    def _flat(self, array: Float32Array) -> Float32Array:
        return array.reshape(self.num_envs, -1)

    @staticmethod
    def _told(what: dict[str, Any], whom: BoolArray) -> dict[str, Any]:
        """As Gymnasium tells it: beside each key a mask (N,) of the slots that it is about."""
        return what | {f"_{key}": whom for key in what}
