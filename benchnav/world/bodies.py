"""Records of dynamic obstacles and relocated static obstacles, and positions from their laws."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import edge_chain
from benchnav.arena.world import World
from benchnav.arrays import AnyArray
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel
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
            row = bodies[b, m]
            before, after = edge_chain(body.solid)
            kind = int(body.solid.kind)
            shapes.append(capsule_records(body.solid.capsules, before, after, m, kind, shape_count))
            knots.append(_set_law(row, body.law, knot_count))
            row["first"], row["last"] = shape_count, shape_count + len(shapes[-1])
            shape_count, knot_count = int(row["last"]), int(row["law_last"])
            row["bound"], row["kind"] = body.solid.bounding_radius, kind
    return bodies, np.concatenate(shapes), np.concatenate(knots)


def law_records(bodies: Sequence[Body]) -> tuple[AnyArray, AnyArray]:
    """Return (bodies (M,), knots (L,)) that hold only the laws, for `body_at`."""
    rows, knots = np.zeros(len(bodies), BODY), [np.zeros(0, KNOT)]
    for m, body in enumerate(bodies):
        knots.append(_set_law(rows[m], body.law, sum(map(len, knots))))
    return rows, np.concatenate(knots)


def _set_law(row: AnyArray, law: Law, first: int) -> AnyArray:
    """Set the law of a body's record, whose knots begin at ``first``; return them."""
    knots = np.zeros(len(law.points), KNOT)
    knots["t"][: len(law.times)] = law.times
    knots["x"], knots["y"] = law.points[:, 0], law.points[:, 1]
    row["law_first"], row["law_last"] = first, first + len(knots)
    row["law"], row["periodic"], row["phase"] = int(law.kind), law.periodic, law.phase
    return knots


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


@kernel
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
