"""The observation and action spaces of an agent, and the information about one decision."""

from typing import cast

import numpy as np
from gymnasium import spaces

from benchnav.arrays import FloatArray
from benchnav.envs.agent_batch import Transition
from benchnav.envs.encoders.encoder import Encoder, Float32Array
from benchnav.envs.reward import TERMS

Space = spaces.Space[Float32Array]


def observation_space(encoder: Encoder) -> Space:
    """Return the encoder's ranges (D,), extended to 0, because idle slots observe zeros."""
    low = np.array([min(n.low, 0.0) for n in encoder.numbers], np.float32)
    high = np.array([max(n.high, 0.0) for n in encoder.numbers], np.float32)
    return cast("Space", spaces.Box(low, high, dtype=np.float32))


def action_space() -> Space:
    """Return (2,): speed from 0 (-1) to the limit (1), and turn rate over its limit (left > 0)."""
    return cast("Space", spaces.Box(-1.0, 1.0, (2,), np.float32))


def last_seen(step: Transition) -> Float32Array:
    """Return the observations (B, A, D) after a decision and before any restart; 0 after an end.

    An attempt that ended by time still has an observation, so that a learner can bootstrap its
    value.
    """
    seen: Float32Array = np.where((step.arrived | step.touched)[..., None], 0.0, step.final)
    seen[~step.acted] = 0.0
    return seen


def terms(step: Transition) -> dict[str, FloatArray]:
    """Return the reward's terms (B, A) by name, before scaling."""
    return {name: getattr(step.terms, name) for name in TERMS}
