"""Rollouts as short sequences without idle transitions."""

from collections.abc import Generator
from typing import Any

import numpy as np
import torch
from sb3_contrib.common.recurrent.type_aliases import RecurrentRolloutBufferSamples, RNNStates

from benchnav.arrays import BoolArray, IntArray
from benchnav.envs import LiveBuffer

from .learner_group import LearnerGroup

CLASSES = 4  # of lengths; a minibatch mixes sequences of one class, if there are enough of it


class SequenceBuffer(LiveBuffer):
    """Cuts the experience of slots into sequences of at most ``length`` decisions.

    A sequence ends with the episode or rollout, before idling, or at ``length``; it
    begins with the LSTM state stored there. Minibatches are random sets of sequences of similar
    length, with about the requested number of decisions, so there is little padding.
    """

    group = LearnerGroup()  # alone

    def __init__(self, *args: Any, state: tuple[int, ...], length: int = 64, **kwargs: Any) -> None:
        """Make an empty buffer. ``state`` (2, 2, layers, H): see `Collector`."""
        self.length = length
        super().__init__(*args, **kwargs)
        shape = (self.buffer_size, self.n_envs, *state)
        # A page that is never written takes no memory: states are stored where sequences begin.
        self.states = torch.empty(shape, device=self.device)

    def reset(self) -> None:
        super().reset()
        self.live = np.zeros((self.buffer_size, self.n_envs), np.bool_)
        self.begins: BoolArray = np.zeros_like(self.live)
        self._since: IntArray = np.zeros(self.n_envs, np.int64)  # decisions of the last sequence

    def begin(self, step: int, slots: IntArray, starts: BoolArray, states: torch.Tensor) -> None:
        """Note which attempts of ``slots`` start, and store ``states`` where sequences begin."""
        begins = starts | (self._since[slots] % self.length == 0)
        self._since[slots] = np.where(begins, 1, self._since[slots] + 1)
        self.live[step, slots] = True
        self.episode_starts[step] = 1.0
        self.episode_starts[step, slots] = starts
        self.begins[step, slots] = begins
        self.states[step, slots[begins]] = states[torch.as_tensor(begins, device=self.device)]

    def put(
        self, step: int, slots: IntArray, observation: Any, action: Any, reward: Any, value: Any,
        log_prob: Any,
    ) -> None:  # fmt: skip
        """Store the decisions of ``slots``."""
        arrays = (self.observations, self.actions, self.rewards, self.values, self.log_probs)
        given = (observation, action, reward, value, log_prob)
        for array, part in zip(arrays, given, strict=True):
            array[step, slots] = part
        self.pos, self.full = step + 1, step + 1 == self.buffer_size

    def sequences(self) -> tuple[IntArray, IntArray, IntArray]:
        """Return (slot, first step, decisions) of every sequence."""
        slot, first = np.nonzero(self.begins.T)
        number = np.cumsum(self.begins.T) - 1  # of the sequence of each step of each slot
        size = np.bincount(number[self.live.T.reshape(-1)], minlength=len(slot))
        return slot, first, size

    def get(  # type: ignore[override]
        self, batch_size: int | None = None
    ) -> Generator[RecurrentRolloutBufferSamples, None, None]:
        slot, first, size = self.sequences()
        order = self.rng.permutation(len(slot))
        kind = -(-size[order] * CLASSES // self.length)
        order = order[np.argsort(-kind, kind="stable")]
        parts = self._parts(size[order], batch_size)
        for k in self.rng.permutation(len(parts)):
            at = order[parts[k]]
            yield self._samples(slot[at], first[at], size[at])

    def _parts(self, size: IntArray, batch_size: int | None) -> list[IntArray]:
        """Divide sequences of these sizes into minibatches, as many in every process."""
        mine = int(size.sum())
        total = sum(self.group.gather(mine))
        batches = max(1, round(total / (batch_size or total)))
        batch = (np.cumsum(size) - size) * batches // mine
        cuts = np.flatnonzero(np.diff(batch)) + 1
        count = min(self.group.gather(len(cuts) + 1))
        return np.split(np.arange(len(size)), cuts[: count - 1])

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

        states = self.states[first, slot].permute(1, 2, 3, 0, 4)  # (2, 2, layers, sequences, H)
        return RecurrentRolloutBufferSamples(
            observations=take(self.observations),
            actions=take(self.actions),
            old_values=take(self.values),
            old_log_prob=take(self.log_probs),
            advantages=take(self.advantages),
            returns=take(self.returns),
            lstm_states=RNNStates(
                *((pair[0].contiguous(), pair[1].contiguous()) for pair in states)
            ),
            episode_starts=torch.zeros(mask.size, device=self.device),  # their states are zero
            mask=self.to_torch(mask.reshape(-1).astype(np.float32)),
        )
