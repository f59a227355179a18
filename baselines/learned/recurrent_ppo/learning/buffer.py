"""Rollouts as short sequences without idle transitions."""

from collections.abc import Generator
from typing import Any

import numpy as np
import torch
from sb3_contrib.common.recurrent.buffers import RecurrentRolloutBuffer
from sb3_contrib.common.recurrent.type_aliases import RecurrentRolloutBufferSamples, RNNStates

from benchnav.arrays import IntArray
from benchnav.envs import LiveBuffer


class SequenceBuffer(LiveBuffer, RecurrentRolloutBuffer):
    """Cuts the experience of slots into sequences of at most ``length`` decisions.

    A sequence ends with the episode or rollout, before idling, or at ``length``; it
    begins with the LSTM state stored there. Minibatches are random sets of sequences
    with about the requested number of decisions, so there is little padding. The learner sets
    ``length``.
    """

    length: int = 64

    def sequences(self) -> tuple[IntArray, IntArray, IntArray]:
        """Return (slot, first step, decisions) of every sequence."""
        starts = self._by_slot(self.episode_starts) > 0.5
        live = self.live.T
        before = np.pad(live[:, :-1], ((0, 0), (1, 0)))
        begins = live & (starts | ~before)
        slot, first = np.nonzero(begins)
        ends = live & np.pad(begins[:, 1:] | ~live[:, 1:], ((0, 0), (0, 1)), constant_values=True)
        _, last = np.nonzero(ends)
        size = last - first + 1
        pieces = -(-size // self.length)
        which = np.repeat(np.arange(len(size)), pieces)
        part = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        cut = part * self.length
        return slot[which], first[which] + cut, np.minimum(size[which] - cut, self.length)

    def get(  # type: ignore[override]
        self, batch_size: int | None = None
    ) -> Generator[RecurrentRolloutBufferSamples, None, None]:
        slot, first, size = self.sequences()
        order = self.rng.permutation(len(slot))
        order = order[np.argsort(size[order] < self.length, kind="stable")]
        total = int(size.sum())
        batches = max(1, round(total / (batch_size or total)))
        done = np.cumsum(size[order]) - size[order]
        batch = np.minimum(done * batches // total, batches - 1)
        for which in self.rng.permutation(batches):
            at = order[batch == which]
            if len(at):
                yield self._samples(slot[at], first[at], size[at])

    def _by_slot(self, array: Any) -> Any:
        return array.reshape(self.buffer_size, self.n_envs, *array.shape[2:]).swapaxes(0, 1)

    def _samples(
        self, slot: IntArray, first: IntArray, size: IntArray
    ) -> RecurrentRolloutBufferSamples:
        longest = int(size.max())
        step = first[:, None] + np.minimum(np.arange(longest), size[:, None] - 1)
        column = np.broadcast_to(slot[:, None], step.shape)
        mask = np.arange(longest) < size[:, None]

        def take(array: Any) -> torch.Tensor:
            taken = array[step, column]
            return self.to_torch(taken.reshape(-1, *taken.shape[2:]))

        def state(array: Any) -> torch.Tensor:
            return self.to_torch(array[first, :, slot].swapaxes(0, 1).copy())

        starts = self.episode_starts[step, column] * (np.arange(longest) == 0)
        return RecurrentRolloutBufferSamples(
            observations=take(self.observations),
            actions=take(self.actions),
            old_values=take(self.values),
            old_log_prob=take(self.log_probs),
            advantages=take(self.advantages),
            returns=take(self.returns),
            lstm_states=RNNStates(
                (state(self.hidden_states_pi), state(self.cell_states_pi)),
                (state(self.hidden_states_vf), state(self.cell_states_vf)),
            ),
            episode_starts=self.to_torch(starts.reshape(-1).astype(np.float32)),
            mask=self.to_torch(mask.reshape(-1).astype(np.float32)),
        )
