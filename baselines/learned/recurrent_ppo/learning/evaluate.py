"""Strict success of a policy, deterministic, over whole worlds."""

from typing import Protocol

import numpy as np

from benchnav.arrays import BoolArray
from benchnav.envs import AgentBatch

from ..actor import Float32Array


class Deciding(Protocol):
    """A policy, such as `Actor`."""

    @property
    def state_size(self) -> int:
        """The number of memory values per agent."""

    def decide(self, x: Float32Array, state: Float32Array) -> Float32Array:
        """Return actions (N, 2) of observations (N, D); advance ``state`` (N, state_size)."""


def evaluate(actor: Deciding, batch: AgentBatch) -> BoolArray:
    """Return which agents (B, A) arrived without contact in each world; False for padding."""
    x = batch.reset(np.arange(batch.rows))
    pending, arrived = batch.active.copy(), np.zeros_like(batch.active)
    shape = pending.shape
    state: Float32Array = np.zeros((pending.size, actor.state_size), np.float32)
    while pending.any():
        pending_slots = pending.reshape(-1)
        memory = state[pending_slots]
        action = np.zeros((pending.size, 2), np.float32)
        action[pending_slots] = actor.decide(x.reshape(pending.size, -1)[pending_slots], memory)
        state[pending_slots] = memory
        step = batch.step(action.reshape(*shape, 2))
        arrived |= pending & step.arrived
        pending &= ~step.over
        x = step.observation
    return arrived
