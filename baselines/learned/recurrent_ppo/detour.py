"""What an agent does that stands where it cannot get on: it tries another way for a while.

Foresight stops who would collide, and a policy that was never stopped while it learned may
insist. After `patience` the agent drives where there is room, rather towards its goal than
away from it, and then lets the policy try again from there.
"""

import math

import numpy as np

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable

PLACE = 0.5  # [m] within which an agent has not got on
LASTS = 2.0  # [s] of a first detour; each further one from about there lasts so much longer,
MOST = 4  # up to so many times
NEAR = 2.0  # [m] within which the place of the last detour is about there
ROOM = 3.0  # [m] of a clear way beyond which more of it is no better
STRIDE = 0.1  # [m] between the places on a way that are tested
MARGIN = 0.05  # [m] that the way must be clear beyond touching; twice as much beside others
COURSES = 24
AGAIN = 2.0  # [m] of room that the last course must have more to be taken again
_X, _Y, _WAITED, _LEFT, _COURSE, _TRIES, _LAST_X, _LAST_Y = range(8)


class Detours:
    """How long each agent has stood, and who is on a detour.

    Args:
        patience: [s] that an agent stands before it tries another way.
    """

    def __init__(self, patience: float) -> None:
        self.patience = patience
        self._kept = RowTable()

    def reset(self, row: int, told: Briefing) -> None:
        """Everybody of the world ``row`` is about to begin."""
        state = np.zeros((len(told), 8))
        state[:, _X : _Y + 1] = told.start
        state[:, _LAST_X:] = math.inf
        self._kept.put(row, state=state, dt=np.full(len(told), told.dt))

    def steer(self, seen: Observation, bodies: Bodies, command: FloatArray) -> None:
        """Replace the twists ``command`` (B, A, 2) of who is on a detour.

        Args:
            seen: with neighbours and edges.
            bodies: of the agents.
            command: twists [m/s, rad/s].
        """
        near, edges = seen.neighbours, seen.edges
        assert near is not None  # noqa: S101 - declared by the pilot
        assert edges is not None  # noqa: S101
        agents = seen.active.shape[1]
        state = self._kept.take("state", seen.rows, agents)
        dt = self._kept.take("dt", seen.rows, agents)

        def flat(array: AnyArray) -> AnyArray:
            return array.reshape(-1, *array.shape[2:])

        _detour(
            np.flatnonzero(seen.active), self.patience, flat(dt), flat(seen.position),
            flat(seen.heading), flat(seen.goal), flat(bodies.radius), flat(bodies.max_speed),
            flat(bodies.max_turn_rate), flat(near.position), flat(near.radius), flat(near.count),
            flat(edges.start), flat(edges.end), flat(edges.count), flat(state), flat(command),
        )  # fmt: skip
        self._kept.write("state", seen.rows, state)


@kernel
def _detour(
    who: IntArray, patience: float, dt: FloatArray, position: FloatArray, heading: FloatArray,
    goal: FloatArray, radius: FloatArray, max_speed: FloatArray, max_turn: FloatArray,
    other: FloatArray, other_radius: FloatArray, others: IntArray, first: FloatArray,
    second: FloatArray, edges: IntArray, state: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    for i in who:
        x, y, s = position[i, 0], position[i, 1], state[i]
        if s[_LEFT] <= 0.0:
            if math.hypot(x - s[_X], y - s[_Y]) > PLACE:
                s[_X], s[_Y], s[_WAITED] = x, y, 0.0
            s[_WAITED] += dt[i]
            if s[_WAITED] <= patience:
                continue
            again = math.hypot(x - s[_LAST_X], y - s[_LAST_Y]) < NEAR
            s[_TRIES] = min(s[_TRIES] + 1.0, float(MOST)) if again else 1.0
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


@kernel
def _course(
    x: float, y: float, ahead: float, last: float, again: bool, radius: float, other: FloatArray,
    other_radius: FloatArray, others: int, first: FloatArray, second: FloatArray, edges: int,
) -> float:  # fmt: skip
    """[rad] that of 24 courses which has most room, and leads rather to the goal ``ahead``."""
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


@kernel
def _room(
    x: float, y: float, course: float, radius: float, other: FloatArray, other_radius: FloatArray,
    others: int, first: FloatArray, second: FloatArray, edges: int,
) -> float:  # fmt: skip
    """[m] of a straight way on which nothing that is seen now is touched."""
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
