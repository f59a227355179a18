"""The world of a rehearsal: the scored world with its leaders only, and other phases of movers."""

from dataclasses import fields, replace

import numpy as np

from benchnav.arena.agents import Agents, Role
from benchnav.arena.body import Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import IntArray
from benchnav.geometry.rotation import TWO_PI


def rehearsal_world(world: World, rng: np.random.Generator) -> tuple[World, IntArray]:
    """Return (world, (L',) indices of its agents in the scored ``world``).

    Walls and static obstacles are those of ``world``; an obstacle that is relocated within the
    episode keeps its first place, as a rehearsal comes before the episode. Movers keep their
    paths and speeds, each with a new phase from ``rng``; a recorded track keeps its
    time. Of the evaluated agents, only `leaders_of` take part; of the others, all.
    """
    index = rehearsing(world.agents)
    agents = Agents(**{f.name: getattr(world.agents, f.name)[index] for f in fields(Agents)})
    role = np.where(agents.evaluated, int(Role.LEADER), agents.role).astype(np.int8)
    standing = [body for body in world.bodies if body.solid.kind == Kind.STATIC]
    moving = [body for body in world.bodies if body.solid.kind != Kind.STATIC]
    placed = tuple(body.solid.moved(body.law.points[0]) for body in standing)
    stale = world.stale_solids
    rehearsed = replace(
        world,
        solids=world.solids + placed,
        bodies=tuple(replace(body, law=_rephased(body.law, rng)) for body in moving),
        agents=replace(agents, role=role),
        stale_solids=None if stale is None else stale + placed,
    )
    return rehearsed, index


def rehearsing(agents: Agents) -> IntArray:
    """Return the indices of the agents in a rehearsal, ascending: leaders and background agents."""
    present = ~agents.evaluated
    present[leaders_of(agents)] = True
    return np.flatnonzero(present)


def leaders_of(agents: Agents) -> IntArray:
    """Return the indices of the evaluated agents that rehearse, ascending.

    These are the leaders; for a team without leaders, the member whose start and goal are nearest
    to the means of its members' starts and goals.
    """
    led: list[int] = []
    for team in np.unique(agents.team[agents.evaluated]):
        members = np.flatnonzero(agents.evaluated & (agents.team == team))
        leaders = members[agents.role[members] == int(Role.LEADER)]
        led += leaders.tolist() if len(leaders) else [_middle(agents, members)]
    return np.array(sorted(led), np.int64)


def _middle(agents: Agents, members: IntArray) -> int:
    away = np.zeros(len(members))
    for places in (agents.start[members], agents.goal[members]):
        offset = places - places.mean(axis=0)
        away += np.sqrt(np.sum(offset * offset, axis=1))
    ties = members[away == away.min()]
    keys = (*agents.goal[ties].T[::-1], *agents.start[ties].T[::-1])
    return int(ties[np.lexsort(keys)[0]])  # independent of the order of the agents


def _rephased(law: Law, rng: np.random.Generator) -> Law:
    share = float(rng.random())
    if law.kind == LawKind.CIRCLE:
        points = law.points.copy()
        points[1, 1] = TWO_PI * share
        return replace(law, points=points)
    if law.kind == LawKind.TRACK and law.periodic:
        return replace(law, phase=float(law.times[-1]) * share)
    return law
