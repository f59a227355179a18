"""Which member follows whose path, and where in the corridor it goes."""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.randomness.agent_streams import canonical_order

from .guiding_path import GuidingPath
from .march import advanced, direction


@dataclass(frozen=True, eq=False)
class Group:
    """A leader and those who follow its way: the leader itself is one of them."""

    leader: int  # place among the agents of the briefing
    members: IntArray  # (N,) rising


def groups_of(briefing: Briefing, leaders: IntArray) -> list[Group]:
    """One group for each of ``leaders`` (L,): who rehearsed, or has the role.

    A leader follows its own way. Others follow the leader of their team whose start and goal
    are nearest to theirs; who has none in the team follows nobody.
    """
    order = np.argsort(canonical_order(briefing))  # ties must not depend on the numbering
    leaders = leaders[np.argsort(order[leaders])]
    follows = np.full(len(briefing), -1)
    follows[leaders] = leaders
    for a in np.flatnonzero(follows < 0):
        own = leaders[briefing.team[leaders] == briefing.team[a]]
        if len(own):
            follows[a] = own[np.argmin(_apart(briefing, int(a), own))]
    return [Group(int(leader), np.flatnonzero(follows == leader)) for leader in leaders]


def leaders_in(briefing: Briefing) -> IntArray:
    """(L,) who rehearsed, or who has the role where nobody did."""
    if briefing.rehearsals:
        return np.unique(np.concatenate([told.agent for told in briefing.rehearsals]))
    return np.flatnonzero(briefing.role == int(Role.LEADER))


def _apart(briefing: Briefing, agent: int, others: IntArray) -> FloatArray:
    away = np.zeros(len(others))
    for places in (briefing.start, briefing.goal):
        offset = places[others] - places[agent]
        away += np.sqrt(np.sum(offset * offset, axis=1))
    return away


def places_in_corridor(path: GuidingPath, start: FloatArray, spread: float) -> FloatArray:
    """(N,) [m] to the left of the path: where members stand at the start, seen along it.

    Where somebody stands farther aside than ``spread`` [m], all move together in
    proportion, so that their order is kept.
    """
    reach = min(2.0 * spread, path.length)
    ux, uy = direction(path.points, path.arc, 0.0, max(reach, 1e-6))
    offset = start - path.points[0]
    left: FloatArray = ux * offset[:, 1] - uy * offset[:, 0]
    widest = float(np.abs(left).max(initial=0.0))
    return left if widest <= spread else left * (spread / widest)


def turn_offs(path: GuidingPath, goal: FloatArray, leaving: float) -> FloatArray:
    """(N,) [m] arc length at which each member leaves the path for its own ``goal`` (N, 2).

    ``leaving`` [m] before the place that is nearest to the goal. Looked for on the stretch
    that is no farther from the path's end, along it, than twice the way from there to the
    goal: the nearest place lies there, and what the path passed by long before does not.
    """
    way, along = path.points, path.arc
    found = np.empty(len(goal))
    for i, (x, y) in enumerate(goal):
        reach = 2.0 * np.hypot(x - way[-1, 0], y - way[-1, 1])
        low = max(0.0, path.length - reach)
        found[i] = advanced(way, along, low, path.length, x, y)
    return np.maximum(found - leaving, 0.0)


def misfit(path: GuidingPath, briefing: Briefing, leader: int) -> tuple[float, float]:
    """[m] between the path's and the leader's start, and between their ends."""
    here = path.points[0] - briefing.start[leader]
    there = path.points[-1] - briefing.goal[leader]
    return float(np.hypot(*here)), float(np.hypot(*there))
