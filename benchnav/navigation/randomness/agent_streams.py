"""Randomness per agent that does not depend on how the agents are numbered."""

import numpy as np

from benchnav.arrays import IntArray
from benchnav.navigation.briefing import Briefing


def canonical_order(briefing: Briefing) -> IntArray:
    """Return (A,) agent indices sorted by start, then goal, then entry, whatever the numbering."""
    goal, start = briefing.goal, briefing.start
    keys = (briefing.enters, goal[:, 1], goal[:, 0], start[:, 1], start[:, 0])
    return np.lexsort(keys).astype(np.int64)


def agent_streams(briefing: Briefing) -> list[np.random.Generator]:
    """Return one generator per agent, spawned from the briefing's in canonical order."""
    streams = briefing.rng.spawn(len(briefing))
    rank = np.argsort(canonical_order(briefing))
    return [streams[int(k)] for k in rank]
