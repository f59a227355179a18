"""Rollouts of Stable-Baselines3 without the steps at which slots are idle."""

from collections.abc import Generator
from typing import Any

import numpy as np
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.type_aliases import RolloutBufferSamples

from benchnav.arrays import BoolArray


class LiveBuffer(RolloutBuffer):
    """Minibatches of decisions only; the learner sets `env`, which distinguishes them."""

    env: Any = None  # an AgentVecEnv
    rng: Any = np.random  # Stable-Baselines3 draws from the global generator, which it seeds

    def reset(self) -> None:
        super().reset()
        self.live: BoolArray = np.zeros((self.buffer_size, self.n_envs), np.bool_)

    def add(self, *args: Any, **kwargs: Any) -> None:
        self.live[self.pos] = self.env.acted
        super().add(*args, **kwargs)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        step, slot = np.nonzero(self.live)
        order = self.rng.permutation(len(step))
        batches = max(1, round(len(step) / (batch_size or len(step))))
        for at in np.array_split(order, batches):
            s, n = step[at], slot[at]
            yield RolloutBufferSamples(
                *(
                    self.to_torch(array[s, n])
                    for array in (
                        self.observations, self.actions, self.values, self.log_probs,
                        self.advantages, self.returns,
                    )
                )
            )  # fmt: skip
