"""Collision prediction: corrects a learned command that would collide.

Static obstacles are predicted to stay, and all others to keep their velocity (the assumption of
velocity obstacles, Eq. 22). Agents are predicted for a shorter time. A dynamic obstacle may also
turn back at once, with a lower weight. A twist is held for a while, 0.3 s or longer where that is
safer, and then the course is kept. A twist of a small lattice replaces the learned one if the sum
of its danger and of its difference is smaller. The constants were tuned by hand: some 90 settings,
each on 20 to 1,500 validation worlds of `leaders/…`, `corridor/bidirectional` and
`crowd/circle-crossing`.
"""

import math

import numpy as np

from benchnav.arena import Kind
from benchnav.arrays import AnyArray, ByteArray, FloatArray, IntArray
from benchnav.envs import Bodies
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel_without_allocation
from benchnav.navigation import Observation

from .sightings import flat

HORIZON = 2.0  # [s] of prediction for dynamic obstacles
AGENT_HORIZON = 1.1  # [s] for agents: most of them avoid others too, and change their velocity
FIXED = 1.5  # [s] for static obstacles, and for obstacles that turn back
HELD = 0.3  # [s] that a twist is held, once or several times, before the course is kept
TICK = 0.1  # [s] between tested positions
MARGIN = 0.05  # [m] of clearance beyond touching; twice as much from dynamic obstacles
HIT = 4.0  # danger of a contact at the end of the longest horizon,
SOONER = 8.0  # and the additional danger of an immediate contact
SLACK = 1e-6  # [m] for rounding, where objects out of reach are left out
BACK = 4.0  # danger of an immediate contact with an obstacle that would have to turn back
SPEEDS = 5
TURNS = 9
_AGENT, _MOVER = int(Kind.AGENT), int(Kind.DYNAMIC)


def foresee(
    observation: Observation,
    bodies: Bodies,
    command: FloatArray,
    tolerance: FloatArray,
    hold: float = HELD,
) -> FloatArray:
    """Return the twists ``command`` (B, A, 2), corrected where they would collide.

    Args:
        observation: with neighbours and edges.
        bodies: of the agents.
        command: twists [m/s, rad/s].
        tolerance: (B, A) [m] of the goal; obstacles behind the goal do not matter.
        hold: [s] largest duration of a twist; multiples of `HELD` up to it are tried.
    """
    out = command.copy()
    _correct(
        flat(out), np.flatnonzero(observation.active), round(hold / HELD),
        *surroundings(observation, bodies, tolerance),
    )  # fmt: skip
    return out


def surroundings(
    observation: Observation, bodies: Bodies, tolerance: FloatArray
) -> tuple[AnyArray, ...]:
    """Return what the kernels of a correction read of each agent, (B · A, …) each."""
    near, edges = observation.neighbours, observation.edges
    assert near is not None  # noqa: S101 - declared by the pilot
    assert edges is not None  # noqa: S101
    return (
        flat(observation.position), flat(observation.heading), flat(observation.goal),
        flat(tolerance), flat(bodies.radius), flat(bodies.max_speed), flat(bodies.max_turn_rate),
        flat(near.position), flat(near.velocity), flat(near.radius), flat(near.kind),
        flat(near.count), flat(edges.start), flat(edges.end), flat(edges.count),
    )  # fmt: skip


@kernel_without_allocation
def _correct(
    out: FloatArray, indices: IntArray, holds: int, position: FloatArray, heading: FloatArray,
    goal: FloatArray, tolerance: FloatArray, radius: FloatArray, max_speed: FloatArray,
    max_turn: FloatArray, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: IntArray, first: FloatArray, second: FloatArray, edges: IntArray,
) -> None:  # fmt: skip
    for i in indices:
        v, w = out[i, 0], out[i, 1]
        way = max(abs(v), max_speed[i]) * (1.0 + SLACK)
        met = _others_in_reach(
            position[i], way * HORIZON, radius[i], other[i], velocity[i], other_radius[i], others[i]
        )
        near = _edges_in_reach(
            position[i], way * FIXED + radius[i], first[i], second[i], edges[i]
        )  # fmt: skip
        best = _danger(
            v, w, position[i], heading[i], goal[i], tolerance[i], radius[i], other[i], velocity[i],
            other_radius[i], kind[i], met, first[i], second[i], near, holds,
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
                    velocity[i], other_radius[i], kind[i], met, first[i], second[i], near, holds,
                )  # fmt: skip
                if cost < best:
                    best = cost
                    out[i, 0], out[i, 1] = cv, cw


@kernel_without_allocation
def _others_in_reach(
    position: FloatArray, way: float, radius: float, other: FloatArray, velocity: FloatArray,
    other_radius: FloatArray, others: int,
) -> int:  # fmt: skip
    """Return how many agents and obstacles to test: those after them cannot be met.

    ``way`` [m] is the longest of the agent before the horizon.
    """
    last = 0
    for j in range(others):
        dx, dy = other[j, 0] - position[0], other[j, 1] - position[1]
        u, s = velocity[j, 0], velocity[j, 1]
        reach = way + math.sqrt(u * u + s * s) * HORIZON + radius + other_radius[j] + 2.0 * MARGIN
        if within(dx, dy, reach + SLACK):
            last = j + 1
    return last


@kernel_without_allocation
def _edges_in_reach(
    position: FloatArray, way: float, first: FloatArray, second: FloatArray, edges: int
) -> int:
    """Return how many edges to test: those after them cannot be met within ``way`` [m]."""
    last = 0
    x, y = position[0], position[1]
    for e in range(edges):
        px, py = nearest_on_segment(x, y, first[e, 0], first[e, 1], second[e, 0], second[e, 1])
        if within(px - x, py - y, way + MARGIN + SLACK):
            last = e + 1
    return last


@kernel_without_allocation
def _danger(
    v: float, w: float, position: FloatArray, heading: float, goal: FloatArray, tolerance: float,
    radius: float, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: int, first: FloatArray, second: FloatArray, edges: int, holds: int,
) -> float:  # fmt: skip
    """Return the danger of a twist, held for the safest duration."""
    least = math.inf
    for k in range(1, holds + 1):
        least = min(
            least,
            danger_held(
                v, w, position, heading, goal, tolerance, radius, other, velocity, other_radius,
                kind, others, first, second, edges, k * HELD,
            ),
        )  # fmt: skip
        if least == 0.0:
            break
    return least


@kernel_without_allocation
def danger_held(
    v: float, w: float, position: FloatArray, heading: float, goal: FloatArray, tolerance: float,
    radius: float, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: int, first: FloatArray, second: FloatArray, edges: int, held: float,
) -> float:  # fmt: skip
    """Return the danger of a twist: at most `BACK` without contact before horizon or goal.

    It is 0 without contact with an obstacle that would have to turn back, either.
    """
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
            if t > AGENT_HORIZON + 1e-9 and kind[j] == _AGENT:
                continue
            reach = radius + other_radius[j] + (2.0 * MARGIN if mover else MARGIN)
            dx, dy = other[j, 0] - x, other[j, 1] - y
            u, s = t * velocity[j, 0], t * velocity[j, 1]
            if mover and t <= FIXED and back == 0.0 and within(dx - u, dy - s, reach):
                back = BACK * (1.0 - k * TICK / FIXED)
            if within(dx + u, dy + s, reach):
                return HIT + SOONER * (1.0 - k * TICK / HORIZON) + back
        if t <= FIXED:
            for e in range(edges):
                px, py = nearest_on_segment(
                    x, y, first[e, 0], first[e, 1], second[e, 0], second[e, 1]
                )
                if within(px - x, py - y, radius + MARGIN):
                    return HIT + SOONER * (1.0 - k * TICK / FIXED) + back
        if within(goal[0] - x, goal[1] - y, tolerance):
            return back
    return back


@kernel_without_allocation
def within(dx: float, dy: float, reach: float) -> bool:
    """Whether the offset (``dx``, ``dy``) is shorter than ``reach``."""
    return bool(dx * dx + dy * dy < reach * reach)
