"""The dynamic window of every agent of a batch.

Fox, Burgard and Thrun 1997, "The dynamic window approach to collision avoidance", IEEE
Robotics & Automation Magazine 4(1):23–33. Comments mark additions to the paper. Rows N are
(world, agent) pairs and independent of each other.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

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


LEAST = 0.01  # [m] of the margin that is kept even if the agent is closer than the margin


@kernel
def window(now: float, change: float, low: float, high: float, out: FloatArray) -> None:
    """Fill ``out`` (n,) evenly with values within ``change`` of ``now`` and in low … high.

    The value nearest to 0 becomes 0 if 0 is in this range (an addition: otherwise no sample drives
    straight).
    """
    first, last = min(max(now - change, low), high), max(min(now + change, high), low)
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
    way = v * dt + 0.5 * v * v / brake
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
def choose(
    low: int, high: int, active: BoolArray, here: FloatArray, heading: FloatArray,
    last: FloatArray, target: FloatArray, remaining: FloatArray, body: FloatArray,
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
        last: (N, 2) the current twist.
        target: (N, 2) [m].
        remaining: (N,) [m] to the place where the agent must stop.
        body: (N, 6) see `baselines.common.kernel_inputs.BODY`.
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
    vs, ws = np.empty(speeds), np.empty(turns)
    brake, turn_brake = search.acceleration, search.turn_acceleration
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, size, dt = here[i, 0], here[i, 1], body[i, 0], body[i, 4]
        standing = 0 if search.predict else count[i]
        moving = count[i] - standing
        top = min(body[i, 2], remaining[i] / dt) if dt > 0.0 else body[i, 2]
        now = last[i, 0]
        window(now, brake * dt, 0.0, max(top, now - brake * dt), vs)
        window(last[i, 1], turn_brake * dt, -body[i, 3], body[i, 3], ws)
        here_room = room(
            x, y, start[i], end[i], edges[i], position[i], radius[i], standing, size + margin
        )
        reach = max(size + LEAST, min(size + margin, here_room - LEAST))
        most = max(far, vs[speeds - 1] * dt + 0.5 * vs[speeds - 1] ** 2 / brake)
        allowed = 0
        for a in range(speeds):
            for b in range(turns):
                v, w = vs[a], ws[b]
                dist = arc_clearance(
                    x, y, heading[i], v, w, reach, start[i], end[i], edges[i],
                    position[i], radius[i], standing, most,
                )  # fmt: skip
                time = meeting_time(
                    x, y, heading[i], v, w, size + margin, position[i], velocity[i], radius[i],
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
                    x, y, heading[i], v, w, target[i, 0], target[i, 1], brake, turn_brake, dt
                )
                score[a, b] = (
                    search.heading * ahead
                    + search.distance * free_share
                    + search.speed * v / body[i, 2]
                )  # fmt: skip
        answer[i, 0], answer[i, 1] = _best(score, free, meets, vs, ws, allowed > 0)
        if answer[i, 0] < 0.0:  # no arc is free: brake along the arc that was free before
            v = max(now - brake * dt, 0.0)
            answer[i, 0] = v
            answer[i, 1] = last[i, 1] * v / now if now > 0.0 else 0.0


@kernel
def _best(
    score: FloatArray, free: FloatArray, meets: FloatArray, vs: FloatArray, ws: FloatArray,
    allowed: bool,
) -> tuple[float, float]:  # fmt: skip
    """Return the twist of the best smoothed score among the allowed ones.

    If there is none, because moving neighbours will meet the agent in any case, the twist
    that meets them last; v = −1 if static obstacles block all.
    """
    v, w, best = -1.0, 0.0, -1.0
    for a in range(len(vs)):
        for b in range(len(ws)):
            if free[a, b] < 0.0 or (allowed and score[a, b] == 0.0):
                continue
            value = smoothed(score, a, b) if allowed else meets[a, b]
            if value > best:
                v, w, best = vs[a], ws[b], value
    return v, w
