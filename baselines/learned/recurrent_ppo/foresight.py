"""Looks ahead before a learned command is obeyed, and corrects it where it would collide.

What stands is predicted to stand and everybody to keep their velocity (the assumption of
velocity obstacles, Eq. 22); a dynamic obstacle may also turn back at once, which is
weighed less. A twist is held for a while, 0.3 s or longer where that is safer, and its
course then kept. A twist of a small lattice replaces the learned one where the sum of its
danger and of its difference is less. The constants were tuned by hand: some 80 settings,
each on 20 to 1,500 validation worlds of `leaders/…`, `corridor/bidirectional` and
`crowd/circle-crossing`.
"""

import math

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel
from benchnav.navigation.observation import Observation

HORIZON = 2.0  # [s] looked ahead at agents and dynamic obstacles
FIXED = 1.5  # [s] at what stands, and at obstacles that turn back
HELD = 0.3  # [s] that a twist is held, once or several times, before the course is kept
TICK = 0.1  # [s] between positions that are tested
MARGIN = 0.05  # [m] kept beyond touching; twice as much from dynamic obstacles
HIT = 4.0  # danger of touching something at the end of the horizon,
SOONER = 8.0  # and so much more if at once
BACK = 4.0  # danger of touching at once what would have to turn back for that
SPEEDS = 5
TURNS = 9
_MOVER = int(Kind.DYNAMIC)


def foresee(
    seen: Observation,
    bodies: Bodies,
    command: FloatArray,
    tolerance: FloatArray,
    hold: float = HELD,
) -> FloatArray:
    """The twists ``command`` (B, A, 2), corrected where they would collide.

    Args:
        seen: with neighbours and edges.
        bodies: of the agents.
        command: twists [m/s, rad/s].
        tolerance: (B, A) [m] of the goal; nothing behind the goal matters.
        hold: [s] that a twist may be held at most; multiples of `HELD` up to it are tried.
    """
    assert seen.neighbours is not None  # noqa: S101 - declared by the encoder
    assert seen.edges is not None  # noqa: S101
    out = command.reshape(-1, 2).copy()
    agents = len(out)
    near, edges = seen.neighbours, seen.edges
    _correct(
        np.flatnonzero(seen.active), seen.position.reshape(agents, 2), seen.heading.reshape(agents),
        seen.goal.reshape(agents, 2), tolerance.reshape(agents), bodies.radius.reshape(agents),
        bodies.max_speed.reshape(agents), bodies.max_turn_rate.reshape(agents),
        near.position.reshape(agents, -1, 2), near.velocity.reshape(agents, -1, 2),
        near.radius.reshape(agents, -1), near.kind.reshape(agents, -1), near.count.reshape(agents),
        edges.start.reshape(agents, -1, 2), edges.end.reshape(agents, -1, 2),
        edges.count.reshape(agents), round(hold / HELD), out,
    )  # fmt: skip
    return out.reshape(command.shape)


@kernel
def _correct(
    who: IntArray, position: FloatArray, heading: FloatArray, goal: FloatArray,
    tolerance: FloatArray, radius: FloatArray, max_speed: FloatArray, max_turn: FloatArray,
    other: FloatArray, velocity: FloatArray, other_radius: FloatArray, kind: ByteArray,
    others: IntArray, first: FloatArray, second: FloatArray, edges: IntArray, holds: int,
    out: FloatArray,
) -> None:  # fmt: skip
    for i in who:
        v, w = out[i, 0], out[i, 1]
        best = _danger(
            v, w, position[i], heading[i], goal[i], tolerance[i], radius[i], other[i], velocity[i],
            other_radius[i], kind[i], others[i], first[i], second[i], edges[i], holds,
        )  # fmt: skip
        if best == 0.0:
            continue
        for a in range(SPEEDS):
            for b in range(TURNS):
                cv = max_speed[i] * a / (SPEEDS - 1)
                cw = max_turn[i] * (2.0 * b / (TURNS - 1) - 1.0)
                apart = abs(cv - v) / max_speed[i] + 0.5 * abs(cw - w) / max_turn[i]
                if apart >= best:
                    continue
                cost = apart + _danger(
                    cv, cw, position[i], heading[i], goal[i], tolerance[i], radius[i], other[i],
                    velocity[i], other_radius[i], kind[i], others[i], first[i], second[i],
                    edges[i], holds,
                )  # fmt: skip
                if cost < best:
                    best = cost
                    out[i, 0], out[i, 1] = cv, cw


@kernel
def _danger(
    v: float, w: float, position: FloatArray, heading: float, goal: FloatArray, tolerance: float,
    radius: float, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: int, first: FloatArray, second: FloatArray, edges: int, holds: int,
) -> float:  # fmt: skip
    """Of a twist, held as long as is safest."""
    least = math.inf
    for k in range(1, holds + 1):
        least = min(
            least,
            _danger_held(
                v, w, position, heading, goal, tolerance, radius, other, velocity, other_radius,
                kind, others, first, second, edges, k * HELD,
            ),
        )  # fmt: skip
        if least == 0.0:
            break
    return least


@kernel
def _danger_held(
    v: float, w: float, position: FloatArray, heading: float, goal: FloatArray, tolerance: float,
    radius: float, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: int, first: FloatArray, second: FloatArray, edges: int, held: float,
) -> float:  # fmt: skip
    """Of a twist: 0 where it touches nothing before the horizon or the goal."""
    x, y, angle = position[0], position[1], heading
    back = 0.0
    for k in range(round(HORIZON / TICK)):
        t = (k + 1) * TICK
        turn = w if t <= held + 1e-9 else 0.0
        middle = angle + 0.5 * turn * TICK
        x += v * TICK * math.cos(middle)
        y += v * TICK * math.sin(middle)
        angle += turn * TICK
        for j in range(others):
            mover = kind[j] == _MOVER
            reach = radius + other_radius[j] + (2.0 * MARGIN if mover else MARGIN)
            dx, dy = other[j, 0] - x, other[j, 1] - y
            u, s = t * velocity[j, 0], t * velocity[j, 1]
            if mover and t <= FIXED and back == 0.0 and _within(dx - u, dy - s, reach):
                back = BACK * (1.0 - k * TICK / FIXED)
            if _within(dx + u, dy + s, reach):
                return HIT + SOONER * (1.0 - k * TICK / HORIZON) + back
        if t <= FIXED:
            for e in range(edges):
                px, py = nearest_on_segment(
                    x, y, first[e, 0], first[e, 1], second[e, 0], second[e, 1]
                )
                if _within(px - x, py - y, radius + MARGIN):
                    return HIT + SOONER * (1.0 - k * TICK / FIXED) + back
        if _within(goal[0] - x, goal[1] - y, tolerance):
            return back
    return back


@kernel
def _within(dx: float, dy: float, reach: float) -> bool:
    return bool(dx * dx + dy * dy < reach * reach)
