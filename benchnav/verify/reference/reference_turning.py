"""Turns of bodies that are not discs in the reference simulator.

It follows the rules of `benchnav.world.turning`: pieces, and bodies that give way.
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arena.world import Charge, ContactRule
from benchnav.arrays import FloatArray
from benchnav.verify.reference.reference_contacts import Partner
from benchnav.verify.reference.reference_footprint import away_from, difference

if TYPE_CHECKING:
    from benchnav.verify.reference.reference_simulator import Twin

SWING, SLACK, GIVES, MAX_TOUCHES = 0.005, 1e-9, 4, 8
_Place = tuple[Partner, int]  # a partner, and the number of its capsule; -1 of a body or an agent
_Pose = tuple[FloatArray, float]  # position (2,) and heading


def turn(twin: "Twin", i: int, angle: float, time: float, h: float) -> None:
    """Turn agent i by ``angle`` [rad], or as far as nothing is in its way."""
    way = abs(angle) * twin.shapes.reach(i)
    near = list(_partners(twin, i, way))
    if min((_gap(twin, i, place, _pose(twin, i))[1] for place in near), default=math.inf) >= way:
        twin.heading[i] += angle
        return
    share = way / min(SWING, 0.5 * float(twin.world.agents.inner_radius[i]))
    pieces = math.ceil(share)
    if abs(share - round(share)) < 1e-9:
        twin.doubtful = True
    touched: list[Partner] = []
    for _ in range(pieces):
        before = _pose(twin, i)
        twin.heading[i] += angle / pieces
        for attempt in range(GIVES + 1):
            growth, normal, place = _worst(twin, i, before)
            if place is None:
                break
            gives = attempt < GIVES and len(touched) < MAX_TOUCHES
            partner = _recorded(twin, place)
            if len(touched) < MAX_TOUCHES and partner not in touched[-1:]:
                touched.append(partner)
                _meet(twin, i, partner, normal, growth * pieces / h, time)
                gives = gives and twin.world.rules.contact == ContactRule.SLIDE
            if not gives:
                twin.position[i], twin.heading[i] = before
                return
            twin.position[i] = twin.position[i] + growth * normal


def _pose(twin: "Twin", i: int) -> _Pose:
    return twin.position[i].copy(), float(twin.heading[i])


def gap_to(twin: "Twin", i: int, place: _Place) -> tuple[FloatArray, float]:
    """Return (unit normal towards agent i, gap [m]) of agent i and a partner."""
    return _gap(twin, i, place, _pose(twin, i))


def _partners(twin: "Twin", i: int, way: float) -> Iterator[_Place]:
    """Yield all that the circle around agent i, enlarged by ``way`` [m], meets."""
    radius = float(twin.world.agents.radius[i])
    for p in np.flatnonzero(twin.fixed_distance(i) < radius + way):
        yield ("solid", int(p)), int(p)
    for m, body in enumerate(twin.world.bodies):
        apart = math.hypot(*(twin.position[i] - twin.bodies[m]))
        if apart < radius + body.solid.bounding_radius + way:
            yield ("body", m), -1
    for j in np.flatnonzero(twin.present):
        apart = math.hypot(*(twin.position[i] - twin.position[j]))
        if j != i and apart < radius + float(twin.world.agents.radius[j]) + way:
            yield ("agent", int(j)), -1


def _gap(twin: "Twin", i: int, place: _Place, pose: _Pose) -> tuple[FloatArray, float]:
    """Return (unit normal towards agent i, gap [m]) with agent i in ``pose``."""
    (name, k), p = place
    at, heading = pose
    core, shapes = twin.shapes.core(i, heading), twin.shapes
    if name == "agent":
        hull = difference(core, shapes.core(k, float(twin.heading[k])))
        normal, apart = away_from(at - twin.position[k], hull)
        return normal, apart - float(shapes.rounding[i] + shapes.rounding[k])
    capsules = twin.capsule(p)[None] if name == "solid" else twin.carried(k)
    found = [(away_from(at, difference(core, c[:4].reshape(2, 2))), float(c[4])) for c in capsules]
    (normal, apart), radius = min(found, key=lambda one: one[0][1] - one[1])
    return normal, apart - radius - float(shapes.rounding[i])


def _worst(twin: "Twin", i: int, before: _Pose) -> tuple[float, FloatArray, _Place | None]:
    """Return (growth [m], normal, partner) of the overlap that grew most since ``before``."""
    most, towards, worst = SLACK, np.zeros(2), None
    for place in _partners(twin, i, 0.0):
        normal, gap = _gap(twin, i, place, _pose(twin, i))
        growth = min(_gap(twin, i, place, before)[1], 0.0) - gap
        if growth > most and -gap > SLACK:
            most, towards, worst = growth, normal, place
    return most, towards, worst


def _recorded(twin: "Twin", place: _Place) -> Partner:
    (name, k), p = place
    return (name, twin.solid_of(p)) if name == "solid" else (name, k)


def _meet(
    twin: "Twin", i: int, partner: Partner, normal: FloatArray, closing: float, time: float
) -> None:
    name, k = partner
    twin.ledger.record(i, partner, time, closing, True)
    if name == "agent":
        active = bool(twin.active[k])
        charged = active or twin.world.rules.charge == Charge.BOTH
        twin.ledger.record(k, ("agent", i), time, closing, charged)
        if active:
            twin.respond(k, -normal, 0.0, time)
    twin.respond(i, normal, 0.0, time)
