"""Strict success of a policy, deterministic, over whole worlds."""

import numpy as np

from benchnav.arrays import BoolArray
from benchnav.envs.agent_batch import AgentBatch

from ..actor import Actor, Float32Array


def evaluate(actor: Actor, batch: AgentBatch) -> BoolArray:
    """(B, A) which agents arrived untouched in each world once; False for padding."""
    x = batch.reset(np.arange(batch.rows))
    pending, arrived = batch.active.copy(), np.zeros_like(batch.active)
    shape = pending.shape
    state: Float32Array = np.zeros((pending.size, actor.state_size), np.float32)
    while pending.any():
        who = pending.reshape(-1)
        memory = state[who]
        action = np.zeros((pending.size, 2), np.float32)
        action[who] = actor.decide(x.reshape(pending.size, -1)[who], memory)
        state[who] = memory
        step = batch.step(action.reshape(*shape, 2))
        arrived |= pending & step.arrived
        pending &= ~step.over
        x = step.observation
    return arrived
