"""Groups: the leader that each member follows, and its place in the corridor."""

from dataclasses import dataclass

import numpy as np

from benchnav.arena import Role
from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, canonical_order

from .guiding_path import GuidingPath
from .march import advanced, direction


@dataclass(frozen=True, eq=False)
class Group:
    """A leader and its followers; the leader is a member, too."""

    leader: int  # place among the agents of the briefing
    members: IntArray  # (N,) ascending


def groups_of(briefing: Briefing, leaders: IntArray) -> list[Group]:
    """Return one group for each of ``leaders`` (L,).

    A leader follows its own path. Others follow the leader of their team whose start and goal
    are nearest to theirs; an agent without a leader in its team is in no group.
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
    """Return the agents (L,) that rehearsed, or without rehearsals those with the role leader."""
    if briefing.rehearsals:
        return np.unique(np.concatenate([r.agent for r in briefing.rehearsals]))
    return np.flatnonzero(briefing.role == int(Role.LEADER))


def _apart(briefing: Briefing, agent: int, others: IntArray) -> FloatArray:
    away = np.zeros(len(others))
    for places in (briefing.start, briefing.goal):
        offset = places[others] - places[agent]
        away += np.sqrt(np.sum(offset * offset, axis=1))
    return away


def places_in_corridor(path: GuidingPath, start: FloatArray, spread: float) -> FloatArray:
    """Return the places (N,) [m] of members to the left of the path at the start.

    If a member is farther aside than ``spread`` [m], all places shrink in
    proportion, so that their order is kept.
    """
    reach = min(2.0 * spread, path.length)
    ux, uy = direction(path.points, path.arc, 0.0, max(reach, 1e-6))
    offset = start - path.points[0]
    left: FloatArray = ux * offset[:, 1] - uy * offset[:, 0]
    widest = float(np.abs(left).max(initial=0.0))
    return left if widest <= spread else left * (spread / widest)


def turn_offs(path: GuidingPath, goal: FloatArray, leaving: float) -> FloatArray:
    """Return the arc length (N,) [m] at which each member leaves the path for its ``goal`` (N, 2).

    It is ``leaving`` [m] before the point nearest to the goal. The search covers the stretch
    that is no farther from the path's end, along it, than twice the distance from there to the
    goal: the nearest point lies there, and points that the path passed long before do not.
    """
    way, along = path.points, path.arc
    found = np.empty(len(goal))
    for i, (x, y) in enumerate(goal):
        reach = 2.0 * np.hypot(x - way[-1, 0], y - way[-1, 1])
        low = max(0.0, path.length - reach)
        found[i] = advanced(way, along, low, path.length, x, y)
    return np.maximum(found - leaving, 0.0)


def misfit(path: GuidingPath, briefing: Briefing, leader: int) -> tuple[float, float]:
    """Return the distances [m] between the starts, and the ends, of the path and the leader."""
    here = path.points[0] - briefing.start[leader]
    there = path.points[-1] - briefing.goal[leader]
    return float(np.hypot(*here)), float(np.hypot(*there))
