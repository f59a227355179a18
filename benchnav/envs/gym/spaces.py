"""What an agent may observe and do, as Gymnasium's spaces, and what is told of one decision."""

from dataclasses import fields
from typing import cast

import numpy as np
from gymnasium import spaces

from benchnav.arrays import FloatArray
from benchnav.envs.agent_batch import Transition
from benchnav.envs.encoders.encoder import Encoder, Float32Array
from benchnav.envs.reward import RewardTerms

Space = spaces.Space[Float32Array]


def observation_space(encoder: Encoder) -> Space:
    """(D,) the encoder's ranges; what is over observes zeros, so zero is always within."""
    low = np.array([min(n.low, 0.0) for n in encoder.numbers], np.float32)
    high = np.array([max(n.high, 0.0) for n in encoder.numbers], np.float32)
    return cast("Space", spaces.Box(low, high, dtype=np.float32))


def action_space() -> Space:
    """(2,) speed from 0 (-1) to the agent's limit (1), and turn rate over its limit, left: > 0."""
    return cast("Space", spaces.Box(-1.0, 1.0, (2,), np.float32))


def last_seen(step: Transition) -> Float32Array:
    """(B, A, D) where each decision led, before any restart; zero where there is no more to see.

    What was cut short by time still sees, so that a learner can value what it missed.
    """
    seen: Float32Array = np.where((step.arrived | step.touched)[..., None], 0.0, step.final)
    seen[~step.acted] = 0.0
    return seen


def terms(step: Transition) -> dict[str, FloatArray]:
    """(B, A) each: the reward's terms by name, before scaling."""
    return {f.name: getattr(step.terms, f.name) for f in fields(RewardTerms)}
