"""Detours of agents that make no progress: they try another way for a while.

Foresight stops agents that would collide, and a policy that was never stopped in training may
insist. After `patience` the agent drives where there is free space, preferably towards its goal,
and then lets the policy try again from there. A crowd moves on by itself, and an agent that turns
back in it drives into others: so an agent makes no detour while it perceives a crowd around it.
"""

import math

import numpy as np

from benchnav.arena import Kind
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.envs import Bodies
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel_without_allocation
from benchnav.navigation import Briefing, Observation, RowTable

from .sightings import flat

PLACE = 0.5  # [m] an agent that stays within this distance makes no progress
LASTS = 2.0  # [s] of a first detour; each further one near it lasts longer by this time,
MAX_FACTOR = 4  # up to this multiple
NEAR = 2.0  # [m] distance within which a detour is near the last one
ROOM = 3.0  # [m] of a clear way, beyond which more is no better
STRIDE = 0.1  # [m] between tested positions on a way
MARGIN = 0.05  # [m] of clearance beyond touching; twice as much beside agents and movers
CROWD = 2  # other agents that are a crowd,
AROUND = 3.0  # [m] within this distance
COURSES = 24
AGAIN = 2.0  # [m] of additional space that the last course needs to be chosen again
_AGENT = int(Kind.AGENT)
_X, _Y, _WAITED, _LEFT, _COURSE, _TRIES, _LAST_X, _LAST_Y = range(8)


class Detours:
    """The standing times of agents, and their detours.

    Args:
        patience: [s] of standing before an agent tries another way.
    """

    def __init__(self, patience: float) -> None:
        self.patience = patience
        self._kept = RowTable()

    def reset(self, row: int, briefing: Briefing) -> None:
        """Reset all agents of the world ``row``."""
        state = np.zeros((len(briefing), 8))
        state[:, _X : _Y + 1] = briefing.start
        state[:, _LAST_X:] = math.inf
        self._kept.put(row, state=state, dt=np.full(len(briefing), briefing.dt))

    def steer(self, observation: Observation, bodies: Bodies, command: FloatArray) -> None:
        """Replace the twists ``command`` (B, A, 2) of agents on a detour.

        Args:
            observation: with neighbours and edges.
            bodies: of the agents.
            command: twists [m/s, rad/s].
        """
        near, edges = observation.neighbours, observation.edges
        assert near is not None  # noqa: S101 - declared by the pilot
        assert edges is not None  # noqa: S101
        agents = observation.active.shape[1]
        state = self._kept.take("state", observation.rows, agents)
        dt = self._kept.take("dt", observation.rows, agents)

        _detour(
            np.flatnonzero(observation.active), self.patience, flat(dt), flat(observation.position),
            flat(observation.heading), flat(observation.goal), flat(bodies.radius),
            flat(bodies.max_speed), flat(bodies.max_turn_rate),
            flat(near.position), flat(near.radius), flat(near.kind), flat(near.count),
            flat(edges.start), flat(edges.end), flat(edges.count), flat(state), flat(command),
        )  # fmt: skip
        self._kept.write("state", observation.rows, state)


def in_crowd(observation: Observation, within: float) -> BoolArray:
    """Whether each agent (B, A) perceives `CROWD` or more other agents ``within`` a distance [m].

    The observation has neighbours.
    """
    near = observation.neighbours
    assert near is not None  # noqa: S101 - declared by the caller
    crowded = np.zeros(observation.active.shape, np.bool_)
    _find_crowds(
        flat(observation.position), flat(near.position), flat(near.kind), flat(near.count), within,
        flat(crowded),
    )  # fmt: skip
    return crowded


@kernel_without_allocation
def _find_crowds(
    position: FloatArray, other: FloatArray, kind: ByteArray, others: IntArray, within: float,
    crowded: BoolArray,
) -> None:  # fmt: skip
    for i in range(len(position)):
        x, y = position[i, 0], position[i, 1]
        crowded[i] = _in_crowd(x, y, other[i], kind[i], others[i], within)


@kernel_without_allocation
def _detour(
    indices: IntArray, patience: float, dt: FloatArray, position: FloatArray, heading: FloatArray,
    goal: FloatArray, radius: FloatArray, max_speed: FloatArray, max_turn: FloatArray,
    other: FloatArray, other_radius: FloatArray, kind: ByteArray, others: IntArray,
    first: FloatArray, second: FloatArray, edges: IntArray, state: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    for i in indices:
        x, y, s = position[i, 0], position[i, 1], state[i]
        if _in_crowd(x, y, other[i], kind[i], others[i], AROUND):
            s[_X], s[_Y], s[_WAITED], s[_LEFT] = x, y, 0.0, 0.0
            continue
        if s[_LEFT] <= 0.0:
            if math.hypot(x - s[_X], y - s[_Y]) > PLACE:
                s[_X], s[_Y], s[_WAITED] = x, y, 0.0
            s[_WAITED] += dt[i]
            if s[_WAITED] <= patience:
                continue
            again = math.hypot(x - s[_LAST_X], y - s[_LAST_Y]) < NEAR
            s[_TRIES] = min(s[_TRIES] + 1.0, float(MAX_FACTOR)) if again else 1.0
            s[_LAST_X], s[_LAST_Y] = x, y
            s[_COURSE] = _course(
                x, y, math.atan2(goal[i, 1] - y, goal[i, 0] - x), s[_COURSE], again, radius[i],
                other[i], other_radius[i], others[i], first[i], second[i], edges[i],
            )  # fmt: skip
            s[_LEFT] = LASTS * s[_TRIES]
        s[_LEFT] -= dt[i]
        if s[_LEFT] <= 0.0:
            s[_X], s[_Y], s[_WAITED] = x, y, 0.0
        error = (s[_COURSE] - heading[i] + math.pi) % (2.0 * math.pi) - math.pi
        out[i, 0] = max_speed[i] * max(0.0, math.cos(error))
        out[i, 1] = min(max(error / dt[i], -max_turn[i]), max_turn[i])


@kernel_without_allocation
def _in_crowd(
    x: float, y: float, other: FloatArray, kind: ByteArray, others: int, within: float
) -> bool:
    near = 0
    for j in range(others):
        if kind[j] == _AGENT and math.hypot(other[j, 0] - x, other[j, 1] - y) < within:
            near += 1
    return near >= CROWD


@kernel_without_allocation
def _course(
    x: float, y: float, ahead: float, last: float, again: bool, radius: float, other: FloatArray,
    other_radius: FloatArray, others: int, first: FloatArray, second: FloatArray, edges: int,
) -> float:  # fmt: skip
    """Return the best of 24 courses [rad] by free space and direction to the goal ``ahead``."""
    best, chosen = -math.inf, ahead
    for k in range(COURSES):
        course = ahead + 2.0 * math.pi * k / COURSES
        value = math.cos(course - ahead)
        if again:
            value -= AGAIN * max(0.0, math.cos(course - last))
        if value + ROOM > best:
            value += _room(x, y, course, radius, other, other_radius, others, first, second, edges)
            if value > best:
                best, chosen = value, course
    return chosen


@kernel_without_allocation
def _room(
    x: float, y: float, course: float, radius: float, other: FloatArray, other_radius: FloatArray,
    others: int, first: FloatArray, second: FloatArray, edges: int,
) -> float:  # fmt: skip
    """Return the length [m] of a straight way without contact, by the current readings."""
    for step in range(round(ROOM / STRIDE)):
        way = STRIDE * (step + 1)
        px, py = x + way * math.cos(course), y + way * math.sin(course)
        for j in range(others):
            away = math.hypot(other[j, 0] - px, other[j, 1] - py)
            if away < radius + other_radius[j] + 2.0 * MARGIN:
                return STRIDE * step
        for e in range(edges):
            qx, qy = nearest_on_segment(
                px, py, first[e, 0], first[e, 1], second[e, 0], second[e, 1]
            )
            if math.hypot(qx - px, qy - py) < radius + MARGIN:
                return STRIDE * step
    return ROOM
