"""Records of dynamic obstacles and relocated static obstacles, and positions from their laws."""

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from benchnav.arena.body import BEYOND, Body, LawKind
from benchnav.arena.world import World
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel_without_allocation
from benchnav.world.records import BODY, KNOT, capsule_records

_TRACK = int(LawKind.TRACK)
_CIRCLE = int(LawKind.CIRCLE)


def stack_bodies(worlds: Sequence[World]) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Return (bodies (B, M), shapes (Q,) capsules in body frames, knots (L,) of the laws)."""
    counts = [len(world.bodies) for world in worlds]
    number = [m for count in counts for m in range(count)]
    solids = [body.solid for world in worlds for body in world.bodies]
    rows, knots = law_records([body for world in worlds for body in world.bodies])
    rows["last"] = np.cumsum([len(solid.capsules) for solid in solids])
    rows["first"][1:] = rows["last"][:-1]
    rows["bound"] = [solid.bounding_radius for solid in solids]
    rows["kind"] = [int(solid.kind) for solid in solids]
    bodies = np.zeros((len(worlds), max(counts)), BODY)
    bodies[np.repeat(np.arange(len(worlds)), counts), number] = rows
    return bodies, capsule_records(solids, number, 0), knots


def law_records(bodies: Sequence[Body]) -> tuple[AnyArray, AnyArray]:
    """Return (bodies (M,), knots (L,)) that hold only the laws, for `body_at`.

    Raises ValueError if a law has more times than points.
    """
    laws = [body.law for body in bodies]
    points = np.concatenate([np.zeros((0, 2)), *(law.points for law in laws)])
    knots, rows = np.zeros(len(points), KNOT), np.zeros(len(laws), BODY)
    knots["x"], knots["y"] = points[:, 0], points[:, 1]
    ends = [0, *accumulate(len(law.points) for law in laws)]
    rows["law_first"], rows["law_last"] = ends[:-1], ends[1:]
    for law, first in zip(laws, ends, strict=False):
        if len(law.times) > len(law.points):
            raise ValueError("a law of motion must not have more times than points")
        knots["t"][first : first + len(law.times)] = law.times
    rows["law"] = [int(law.kind) for law in laws]
    rows["periodic"] = [law.periodic for law in laws]
    rows["phase"] = [law.phase for law in laws]
    return rows, knots


@kernel_without_allocation
def start_bodies(bodies: AnyArray, count: IntArray, knots: AnyArray, h: FloatArray) -> None:
    """Put the bodies (B, M) at t = 0, with the velocity of a first substep of ``h`` (B,) [s].

    ``count`` (B,) is the number of bodies of each world.
    """
    for b in range(len(bodies)):
        for m in range(count[b]):
            body = bodies[b, m]
            body.x, body.y = body_at(body, knots, 0.0)
            x, y = body_at(body, knots, h[b])
            if is_away(x, y) == is_away(body.x, body.y):
                body.vx, body.vy = (x - body.x) / h[b], (y - body.y) / h[b]


@kernel_without_allocation
def top_speeds(bodies: AnyArray, count: IntArray, knots: AnyArray, top: FloatArray) -> None:
    """Write the largest speed [m/s] of any body's law in each world to ``top`` (B,)."""
    for b in range(len(bodies)):
        for m in range(count[b]):
            first, last = bodies[b, m].law_first, bodies[b, m].law_last - 1
            if bodies[b, m].law == _CIRCLE:
                top[b] = max(top[b], abs(knots[first].t * knots[last].x))
            elif bodies[b, m].law == _TRACK:
                for k in range(first, last):
                    if is_away(knots[k].x, knots[k].y) or is_away(knots[k + 1].x, knots[k + 1].y):
                        continue
                    dx, dy = knots[k + 1].x - knots[k].x, knots[k + 1].y - knots[k].y
                    step = knots[k + 1].t - knots[k].t
                    if step > 0.0:
                        top[b] = max(top[b], math.sqrt(dx * dx + dy * dy) / step)


@kernel_without_allocation
def is_away(x: float, y: float) -> bool:
    """Whether (x, y) [m] is the position of an absent body."""
    return abs(x) > BEYOND or abs(y) > BEYOND


@kernel_without_allocation
def body_at(body: Any, knots: AnyArray, time: float) -> tuple[float, float]:
    """Return a body's position [m] at ``time`` [s]; of a relocated one, its current position."""
    first, last = body.law_first, body.law_last - 1
    if body.law == _CIRCLE:
        c, s = cos_sin(knots[last].y + knots[first].t * time)
        return knots[first].x + knots[last].x * c, knots[first].y + knots[last].x * s
    if body.law != _TRACK:
        at = last if body.placed else first
        return knots[at].x, knots[at].y
    t = time + body.phase
    end = knots[last].t
    if body.periodic and end > 0.0:
        t = t - math.floor(t / end) * end
    if t >= end:
        return knots[last].x, knots[last].y
    if t <= knots[first].t:
        return knots[first].x, knots[first].y
    low, high = first, last
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle].t <= t:
            low = middle
        else:
            high = middle
    a, b = knots[low], knots[high]
    u = (t - a.t) / (b.t - a.t)
    return a.x + u * (b.x - a.x), a.y + u * (b.y - a.y)
