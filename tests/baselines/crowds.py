"""Random batches for tests of navigators: what they are told and what they see."""

from dataclasses import fields, replace

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Edges, Neighbours

DT = 0.2


def keyed(world):
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([7, world])))


def briefing(start, goal, *, world=0, radius=0.3, map=None, preferred=1.0, limit=1.5):
    """What holonomic agents at ``start`` (A, 2) are told."""
    agents = len(start)
    return Briefing(
        dt=DT, horizon=60.0, goal_tolerance=0.2, decision_budget=None,
        start=np.array(start, float), heading=np.linspace(0.0, 3.0, agents),
        goal=np.array(goal, float), radius=np.full(agents, radius),
        max_speed=np.full(agents, limit), preferred_speed=np.full(agents, preferred),
        max_turn_rate=np.full(agents, np.pi), dynamics=np.zeros(agents, np.int8),
        role=np.zeros(agents, np.int8), team=np.zeros(agents, np.int64), map=map,
        rng=keyed(world),
    )  # fmt: skip


def box_edges(x, y, half):
    """(4, 8) start, end, before, after of a square, solid to the left."""
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half + (x, y)
    end = np.roll(corner, -1, axis=0)
    along = (end - corner) / (2 * half)
    return np.hstack([corner, end, np.roll(along, 1, axis=0), np.roll(along, -1, axis=0)])


def sees(position, velocity, mover, most=6):
    """Neighbours of one world's agents (A, 2), the last ``mover`` of whom are only seen."""
    agents = len(position) - mover
    distance = np.hypot(*np.moveaxis(position[:agents, None] - position[None], -1, 0))
    distance[np.arange(agents), np.arange(agents)] = np.inf
    order = np.argsort(distance, axis=1, kind="stable")[:, :most]
    kind = np.where(np.arange(len(position)) < agents, int(Kind.AGENT), int(Kind.DYNAMIC))
    return Neighbours(
        position[order], velocity[order], np.full(order.shape, 0.3),
        kind[order].astype(np.int8), np.full(agents, order.shape[1]),
    )  # fmt: skip


def faces(position, boxes, most=5):
    """Edges of ``boxes`` (N, 3) that face each of one world's agents (A, 2)."""
    edge = np.vstack([box_edges(*b) for b in boxes])
    a, b = edge[:, 0:2], edge[:, 2:4]
    rows = np.zeros((len(position), most, 8))
    count = np.zeros(len(position), np.int64)
    for i, p in enumerate(position):
        outside = (b - a)[:, 0] * (p - a)[:, 1] - (b - a)[:, 1] * (p - a)[:, 0] < 0
        t = np.clip(((p - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1), 0, 1)
        distance = np.hypot(*(p - a - t[:, None] * (b - a)).T)
        chosen = np.argsort(np.where(outside, distance, np.inf), kind="stable")
        chosen = chosen[outside[chosen]][:most]
        rows[i, : len(chosen)], count[i] = edge[chosen], len(chosen)
    convex = np.ones((len(position), most), bool)
    return Edges(*np.split(rows, 4, axis=-1), convex, convex, count)


def one_world(world, agents, mover=1, spread=4.0):
    """(briefing, observation of one world) with neighbours, a mover and two boxes."""
    rng = np.random.default_rng([3, world])
    everybody = rng.uniform(-spread, spread, (agents + mover, 2))
    velocity = rng.normal(0, 0.5, (agents + mover, 2))
    position, goal = everybody[:agents], rng.uniform(-spread, spread, (agents, 2))
    boxes = [(spread + 1.0, 0.0, 0.8), (0.0, -spread - 1.5, 1.0)]
    seen = Observation(
        rows=np.array([world]),
        time=np.zeros(1),
        active=np.ones((1, agents), bool),
        position=position[None],
        heading=np.zeros((1, agents)),
        velocity=velocity[None, :agents],
        goal=goal[None],
        maps=(None,),
        rays=None,
        neighbours=_batched(sees(everybody, velocity, mover)),
        edges=_batched(faces(position, boxes)),
    )
    return briefing(position, goal, world=world), seen


def _batched(part):
    return replace(part, **{f.name: getattr(part, f.name)[None] for f in fields(part)})


def joined(observations):
    """One observation of several worlds that have as many agents."""

    def glue(parts):
        if parts[0] is None:
            return None
        if isinstance(parts[0], tuple):
            return tuple(item for part in parts for item in part)
        if isinstance(parts[0], np.ndarray):
            return np.concatenate(parts)
        changes = {f.name: glue([getattr(p, f.name) for p in parts]) for f in fields(parts[0])}
        return replace(parts[0], **changes)

    return glue(observations)


def permuted(told, seen, order):
    """The same world with its agents numbered otherwise."""
    per_agent = ("start", "heading", "goal", "radius", "max_speed", "preferred_speed")
    told = replace(told, **{name: getattr(told, name)[order] for name in per_agent})

    def shuffle(part, skip=()):
        names = [f.name for f in fields(part) if f.name not in skip]
        arrays = {n: getattr(part, n) for n in names if isinstance(getattr(part, n), np.ndarray)}
        return replace(part, **{n: array[:, order] for n, array in arrays.items()})

    changed = shuffle(seen, skip=("rows", "time"))
    parts = {
        name: shuffle(getattr(seen, name))
        for name in ("neighbours", "edges")
        if getattr(seen, name) is not None
    }
    return told, replace(changed, **parts)


def answers(navigator, told, seen):
    """Commands of a fresh navigator for worlds that it was told about in their order."""
    navigator.reset(told, seen.rows)
    return navigator.act(seen)
