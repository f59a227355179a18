"""The dynamic window of every agent of a batch.

Fox, Burgard and Thrun 1997, "The dynamic window approach to collision avoidance", IEEE
Robotics & Automation Magazine 4(1):23–33. Comments mark additions to the paper. Rows N are
(world, agent) pairs and independent of each other.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arena import Dynamics
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

from ...common.car import car_target
from ...common.motion_limits import (
    BRAKE,
    KIND,
    TURN_UP,
    speed_window,
    stopping_speed,
    turn_window,
)
from .clearance import arc_clearance, meeting_time, room


class Search(NamedTuple):
    """Parameters of the search: plain numbers, which cost a kernel nothing to hold in a tuple."""

    acceleration: float  # [m/s²]
    turn_acceleration: float  # [rad/s²]
    heading: float  # α, weight of the heading
    distance: float  # β, weight of the distance
    speed: float  # γ, weight of the velocity
    margin: float  # [m] kept from all obstacles
    far: float  # [m] clearance that counts as free
    horizon: float  # [s] of the prediction of neighbours
    hold: float  # [s] after which a turning agent is predicted to go straight
    predict: bool  # neighbours keep their velocities (not from the paper); else they stand still
    speeds: int  # samples of v
    turns: int  # samples of w


_CAR = float(Dynamics.ACKERMANN)
LEAST = 0.01  # [m] of the margin that is kept even if the agent is closer than the margin


@kernel
def window(now: float, change: float, low: float, high: float, out: FloatArray) -> None:
    """Fill ``out`` (n,) evenly with values within ``change`` of ``now`` and in low … high.

    The value nearest to 0 becomes 0 if 0 is in this range (an addition: otherwise no sample drives
    straight).
    """
    evenly(min(max(now - change, low), high), max(min(now + change, high), low), out)


@kernel
def evenly(first: float, last: float, out: FloatArray) -> None:
    """Fill ``out`` (n,) evenly from first to last; the value nearest to 0 becomes 0 if it can."""
    n, nearest = len(out), 0
    for k in range(n):
        out[k] = first + (last - first) * k / (n - 1)
        if abs(out[k]) < abs(out[nearest]):
            nearest = k
    if first <= 0.0 <= last:
        out[nearest] = 0.0


@kernel
def admissible(v: float, w: float, dist: float, brake: float, turn_brake: float, dt: float) -> bool:
    """Whether a body that drives so for a step can still stop within ``dist`` [m] (Eq. 14).

    The step itself is an addition. Turning must end there, too: at radius v / w in it,
    the arc of length dist turns by dist · w / v, and w² / (2 · turn_brake) must not exceed it.
    """
    way = v * dt + 0.5 * v * v / brake
    return way <= dist and abs(w) * v <= 2.0 * dist * turn_brake


@kernel
def rest_turn(w: float, turn_brake: float, dt: float) -> float:
    """Return the turn [rad] of a body that keeps w for a step and then brakes at its limit."""
    return w * dt + 0.5 * w * abs(w) / turn_brake


@kernel
def facing(
    x: float, y: float, heading: float, v: float, w: float, tx: float, ty: float,
    brake: float, turn_brake: float, dt: float,
) -> float:  # fmt: skip
    """Return 1 if the target lies ahead, 0 if behind, of the pose where the body would stop.

    It keeps (v, w) for a step and then brakes at its limit.
    """
    turn = rest_turn(w, turn_brake, dt)
    way = v * dt + 0.5 * v * abs(v) / brake
    px, py = x + way * math.cos(heading + 0.5 * turn), y + way * math.sin(heading + 0.5 * turn)
    off = math.atan2(ty - py, tx - px) - heading - turn
    return 1.0 - abs(math.atan2(math.sin(off), math.cos(off))) / math.pi


@kernel
def smoothed(score: FloatArray, a: int, b: int) -> float:
    """Return the mean of a cell and its neighbours (σ of the objective), without missing cells."""
    total, cells = 0.0, 0
    for i in range(max(a - 1, 0), min(a + 2, score.shape[0])):
        for j in range(max(b - 1, 0), min(b + 2, score.shape[1])):
            total += score[i, j]
            cells += 1
    return total / cells


@kernel
def free_window(
    now: float, turn: float, top: float, turn_rate: float, dt: float, search: Search,
    vs: FloatArray, ws: FloatArray,
) -> None:  # fmt: skip
    """Fill ``vs`` (S,) and ``ws`` (S, T) with the twists that the search's own limits allow.

    ``now`` and ``turn`` are the current twist, ``top`` [m/s] is the highest speed to take.
    """
    change = search.acceleration * dt
    window(now, change, 0.0, max(top, now - change), vs)
    for a in range(len(vs)):
        window(turn, search.turn_acceleration * dt, -turn_rate, turn_rate, ws[a])


@kernel
def body_window(
    now: float, turn: float, steering: float, top: float, limits: FloatArray, dt: float,
    search: Search, vs: FloatArray, ws: FloatArray,
) -> None:  # fmt: skip
    """Fill ``vs`` and ``ws`` like `free_window`, within the limits of the body too.

    A turn rate of 0 is taken if it can be reached. A body that can drive backwards takes no more
    than ``top`` [m/s] either way.
    """
    low, high = speed_window(limits, now, turn, dt)
    up, down = search.acceleration * dt, search.acceleration * dt
    low, high = max(low, now - down, min(-top, high)), min(high, now + up, max(top, low))
    evenly(low, max(high, low), vs)
    for a in range(len(vs)):
        low, high = turn_window(limits, turn, steering, vs[a], dt)
        change = search.turn_acceleration * dt
        if limits[KIND] != _CAR:
            low, high = min(max(low, turn - change), high), max(min(high, turn + change), low)
        evenly(low, high, ws[a])


@kernel
def choose(
    low: int, high: int, active: BoolArray, here: FloatArray, heading: FloatArray,
    last: FloatArray, target: FloatArray, remaining: FloatArray, body: FloatArray,
    limited: BoolArray, limits: FloatArray, backing: BoolArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, count: IntArray,
    start: FloatArray, end: FloatArray, edges: IntArray,
    search: Search, answer: FloatArray,
) -> None:  # fmt: skip
    """Write twists [m/s, rad/s] into rows low … high - 1 of ``answer`` (N, 2).

    Args:
        low: first row.
        high: one past the last row.
        active: (N,) rows to write.
        here: (N, 2) [m].
        heading: (N,) [rad].
        last: (N, 3) the current twist and steering angle [rad].
        target: (N, 2) [m].
        remaining: (N,) [m] to the place where the agent must stop.
        body: (N, 6) see `baselines.common.kernel_inputs.BODY`.
        limited: (N,) whether the body has more limits than speed and turn rate.
        limits: (N, 13) see `baselines.common.motion_limits`.
        backing: (N,) whether a car drives backwards because it stood.
        position: (N, K, 2) of neighbours [m].
        velocity: (N, K, 2) [m/s].
        radius: (N, K) [m].
        count: (N,) valid neighbours.
        start: (N, E, 2) of edges [m].
        end: (N, E, 2) [m].
        edges: (N,) valid edges.
        search: parameters of the search.
        answer: (N, 2).
    """
    speeds, turns, margin, far = search.speeds, search.turns, search.margin, search.far
    horizon, hold = search.horizon, search.hold
    score, free = np.empty((speeds, turns)), np.empty((speeds, turns))
    meets = np.empty((speeds, turns))
    vs, ws = np.empty(speeds), np.empty((speeds, turns))
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, size, dt = here[i, 0], here[i, 1], body[i, 0], body[i, 4]
        standing = 0 if search.predict else count[i]
        moving = count[i] - standing
        now, turn = last[i, 0], last[i, 1]
        tx, ty = target[i, 0], target[i, 1]
        brake, turn_brake, car = search.acceleration, search.turn_acceleration, False
        if limited[i]:
            brake, turn_brake = min(brake, limits[i, BRAKE]), min(turn_brake, limits[i, TURN_UP])
            car = limits[i, KIND] == _CAR
            if car:
                _, tx, ty = car_target(limits[i], x, y, heading[i], now, tx, ty, backing[i])
            top = min(body[i, 2], stopping_speed(remaining[i], brake, dt))
            body_window(now, turn, last[i, 2], top, limits[i], dt, search, vs, ws)
        else:
            top = min(body[i, 2], remaining[i] / dt) if dt > 0.0 else body[i, 2]
            free_window(now, turn, top, body[i, 3], dt, search, vs, ws)
        here_room = room(
            x, y, start[i], end[i], edges[i], position[i], radius[i], standing, size + margin
        )
        reach = max(size + LEAST, min(size + margin, here_room - LEAST))
        fastest = max(vs[speeds - 1], -vs[0])
        most = max(far, fastest * dt + 0.5 * fastest**2 / brake)
        allowed = 0
        for a in range(speeds):
            for b in range(turns):
                v, w, course = abs(vs[a]), ws[a, b], heading[i]
                if vs[a] < 0.0:  # backwards is forwards with the opposite heading
                    course += math.pi
                if car:  # it turns as long as it drives
                    turn_brake = abs(w) * brake / v if v > 0.0 and w != 0.0 else 1.0
                dist = arc_clearance(
                    x, y, course, v, w, reach, start[i], end[i], edges[i],
                    position[i], radius[i], standing, most,
                )  # fmt: skip
                time = meeting_time(
                    x, y, course, v, w, size + margin, position[i], velocity[i], radius[i],
                    moving, horizon, hold,
                )  # fmt: skip
                score[a, b], free[a, b], meets[a, b] = 0.0, -1.0, time
                if not admissible(v, w, dist, brake, turn_brake, dt):
                    continue
                free[a, b] = dist
                if time < horizon and time < dt + v / brake:
                    continue
                if v == 0.0:  # an addition: on the spot, the direction after the turn counts
                    turned = heading[i] + rest_turn(w, turn_brake, dt)
                    dist = arc_clearance(
                        x, y, turned, body[i, 2], 0.0, reach, start[i], end[i], edges[i],
                        position[i], radius[i], standing, most,
                    )  # fmt: skip
                    time = meeting_time(
                        x, y, turned, body[i, 2], 0.0, size + margin, position[i], velocity[i],
                        radius[i], moving, horizon, hold,
                    )  # fmt: skip
                free_share = min(min(dist, far) / far, time / horizon)
                allowed += 1
                ahead = facing(
                    x, y, course if car else heading[i], v if car else vs[a], w, tx, ty, brake,
                    turn_brake, dt,
                )  # fmt: skip
                score[a, b] = (
                    search.heading * ahead
                    + search.distance * free_share
                    + search.speed * max(vs[a], 0.0) / body[i, 2]
                )  # fmt: skip
        found, answer[i, 0], answer[i, 1] = _best(score, free, meets, vs, ws, allowed > 0)
        if not found:  # no arc is free: brake along the arc that was free before
            v = max(now - brake * dt, 0.0) if now > 0.0 else min(now + brake * dt, 0.0)
            answer[i, 0] = v
            answer[i, 1] = turn * v / now if now != 0.0 else 0.0
            if limited[i]:
                first, second = turn_window(limits[i], turn, last[i, 2], v, dt)
                answer[i, 1] = min(max(answer[i, 1], first), second)


@kernel
def _best(
    score: FloatArray, free: FloatArray, meets: FloatArray, vs: FloatArray, ws: FloatArray,
    allowed: bool,
) -> tuple[bool, float, float]:  # fmt: skip
    """Return (True, twist of the best smoothed score among the allowed ones).

    If there is none, because moving neighbours will meet the agent in any case, it is the twist
    that meets them last; (False, …) if static obstacles block all.
    """
    v, w, best = 0.0, 0.0, -1.0
    for a in range(len(vs)):
        for b in range(ws.shape[1]):
            if free[a, b] < 0.0 or (allowed and score[a, b] == 0.0):
                continue
            value = smoothed(score, a, b) if allowed else meets[a, b]
            if value > best:
                v, w, best = vs[a], ws[a, b], value
    return best >= 0.0, v, w
