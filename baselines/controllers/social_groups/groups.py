"""Groups of agents that walk together, and the times at which they stand."""

import math
from collections.abc import Sequence

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation import Briefing, canonical_order

MOST_STOPS = 16  # of a group in an episode
TOGETHER = 2.0  # [s] within which members of a group enter (not from the paper)


def form_groups(briefing: Briefing, shares: Sequence[float], reach: float) -> list[IntArray]:
    """Return groups of agent indices: every agent is in one group.

    A group forms around an agent, in random order, from the agents of its team that are in no
    group yet, that enter at most `TOGETHER` before or after it, and whose starts and goals are
    both within ``reach`` [m] of its own: those with the smallest sum of both distances. Where too
    few are within reach, the group is smaller.
    The groups do not depend on how the agents are numbered.

    Args:
        briefing: of the agents; its generator draws.
        shares: relative frequencies of groups of 1, 2, 3, … members.
        reach: [m].
    """
    order = canonical_order(briefing)
    start, goal, team = briefing.start[order], briefing.goal[order], briefing.team[order]
    enters = briefing.enters[order]
    free: BoolArray = np.ones(len(order), np.bool_)
    limits = np.cumsum(shares) / math.fsum(shares)
    groups = []
    for rank in briefing.rng.permutation(len(order)):
        if not free[rank]:
            continue
        size = 1 + int(np.searchsorted(limits[:-1], briefing.rng.random(), side="right"))
        apart, ends = _distance(start, start[rank]), _distance(goal, goal[rank])
        free[rank] = False
        beside = (team == team[rank]) & (abs(enters - enters[rank]) <= TOGETHER)
        near = np.flatnonzero(free & beside & (np.maximum(apart, ends) <= reach))
        nearest = near[np.argsort((apart + ends)[near], kind="stable")[: size - 1]]
        free[nearest] = False
        groups.append(order[np.sort(np.append(nearest, rank))])
    return groups


def companions_of(groups: Sequence[IntArray], agents: int, most: int) -> IntArray:
    """Return (agents, most): 1 + the index of each other member of an agent's group; 0: none."""
    table = np.zeros((agents, most), np.int64)
    for group in groups:
        for member in group:
            table[member, : len(group) - 1] = 1 + group[group != member]
    return table


def draw_changes(walk: float, stand: float, rng: np.random.Generator) -> FloatArray:
    """Return the times (2 `MOST_STOPS`,) [s] at which a group stops and goes on, by turns.

    Args:
        walk: mean time [s] of walking before each stop, exponentially distributed.
        stand: mean duration [s] of a stop, likewise.
        rng: the generator.
    """
    spans = rng.standard_exponential((MOST_STOPS, 2)) * (walk, stand)
    changes: FloatArray = np.cumsum(spans)
    return changes


def standing(changes: FloatArray, time: FloatArray) -> BoolArray:
    """Whether agents (B, A) stand at ``time`` (B,) [s]; ``changes`` (B, A, C) as drawn."""
    passed = np.count_nonzero(changes <= time[:, None, None], axis=-1)
    stands: BoolArray = passed % 2 == 1
    return stands


def _distance(points: FloatArray, point: FloatArray) -> FloatArray:
    distance: FloatArray = np.sqrt(np.sum((points - point) ** 2, axis=1))
    return distance
