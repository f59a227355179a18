"""Rollouts of sb3-contrib's RecurrentPPO without the steps at which slots are idle."""

from collections.abc import Generator
from typing import Any

import numpy as np
from sb3_contrib.common.recurrent.buffers import RecurrentRolloutBuffer
from sb3_contrib.common.recurrent.type_aliases import RecurrentRolloutBufferSamples

from benchnav.arrays import BoolArray

_LEAST = 2  # decisions of a minibatch: advantages are divided by their standard deviation


class LiveRecurrentBuffer(RecurrentRolloutBuffer):
    """Marks idle steps as padding, which has no loss; `env` is an `AgentVecEnv`."""

    env: Any = None

    def reset(self) -> None:
        super().reset()  # type: ignore[no-untyped-call]
        self.live: BoolArray = np.zeros((self.buffer_size, self.n_envs), np.bool_)

    def add(self, *args: Any, **kwargs: Any) -> None:
        self.live[self.pos] = self.env.acted
        super().add(*args, **kwargs)

    def get(  # type: ignore[override]
        self, batch_size: int | None = None
    ) -> Generator[RecurrentRolloutBufferSamples, None, None]:
        for samples in super().get(batch_size):
            if float(samples.mask.sum()) >= _LEAST:
                yield samples

    def _get_samples(self, batch_inds: Any, *args: Any, **kwargs: Any) -> Any:
        samples = super()._get_samples(batch_inds, *args, **kwargs)
        live = self.swap_and_flatten(self.live[..., None]).reshape(-1)
        return samples._replace(mask=self.pad_and_flatten(live[batch_inds].astype(np.float32)))
