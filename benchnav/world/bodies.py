"""Records of dynamic obstacles and relocated static obstacles, and positions from their laws."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.body import Body, LawKind
from benchnav.arena.solid import edge_chain
from benchnav.arena.world import World
from benchnav.arrays import AnyArray
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel_without_allocation
from benchnav.world.records import BODY, CAPSULE, KNOT, capsule_records

_TRACK = int(LawKind.TRACK)
_CIRCLE = int(LawKind.CIRCLE)


def stack_bodies(worlds: Sequence[World]) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Return (bodies (B, M), shapes (Q,) capsules in body frames, knots (L,) of the laws)."""
    most = max(len(world.bodies) for world in worlds)
    bodies = np.zeros((len(worlds), most), BODY)
    shapes, knots = [np.zeros(0, CAPSULE)], [np.zeros(0, KNOT)]
    shape_count = knot_count = 0
    for b, world in enumerate(worlds):
        for m, body in enumerate(world.bodies):
            row, law = bodies[b, m], body.law
            before, after = edge_chain(body.solid)
            kind = int(body.solid.kind)
            shapes.append(capsule_records(body.solid.capsules, before, after, m, kind, shape_count))
            knots.append(_knots(body))
            row["first"], row["last"] = shape_count, shape_count + len(shapes[-1])
            row["law_first"], row["law_last"] = knot_count, knot_count + len(knots[-1])
            shape_count, knot_count = int(row["last"]), int(row["law_last"])
            row["bound"], row["kind"] = body.solid.bounding_radius, kind
            row["law"], row["periodic"], row["phase"] = int(law.kind), law.periodic, law.phase
    return bodies, np.concatenate(shapes), np.concatenate(knots)


def _knots(body: Body) -> AnyArray:
    law = body.law
    out = np.zeros(len(law.points), KNOT)
    out["t"][: len(law.times)] = law.times
    out["x"], out["y"] = law.points[:, 0], law.points[:, 1]
    return out


def top_speed(world: World) -> float:
    """Return the largest speed [m/s] of any body's law."""
    top = 0.0
    for law in (body.law for body in world.bodies):
        if law.kind == LawKind.CIRCLE:
            top = max(top, abs(float(law.times[0] * law.points[1, 0])))
        elif law.kind == LawKind.TRACK and len(law.times) > 1:
            step = np.diff(law.times)
            length = np.hypot(*np.diff(law.points, axis=0).T)[step > 0]
            top = max(top, float((length / step[step > 0]).max(initial=0.0)))
    return top


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
