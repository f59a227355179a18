"""Sensor readings of an agent as the number of one of finitely many situations.

Seven rays, 30° apart over the front half, count by the time in which the agent at its
preferred speed reaches the objects that they hit. A mover counts as nearer by the distance that
it approaches meanwhile; obstacles behind the goal do not count.
"""

import math

import numpy as np

from benchnav.arena import Kind
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry import angle_of, cos_sin
from benchnav.kernels import kernel
from benchnav.navigation import Observation

ENCODER = "q-7rays-1"  # must change if the meaning of a situation's number changes
DIRECTIONS = np.array([-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0])  # [deg] from the heading
LEVELS = (9, 2, 5, 4, 4, 3, 3, 4)  # bearing, far, ahead, 30° left, right, aside left, right, mover
SITUATIONS = math.prod(LEVELS)

_AGENT, _MOVER = int(Kind.AGENT), int(Kind.DYNAMIC)
_BEARING = np.deg2rad([-110.0, -60.0, -30.0, -10.0, 10.0, 30.0, 60.0, 110.0])
_AHEAD = np.array([0.25, 0.5, 1.0, 2.0])  # [s]
_OBLIQUE = np.array([0.2, 0.45, 1.0])  # [s] at 30°
_ASIDE = np.array([0.12, 0.4])  # [s] at 60° and, half as far, at 90°
_NEAR = 0.9  # [s] to the goal
_WARY = 1.75  # [s] to another agent or a mover
_LEAD = 0.6  # [s] for which a mover is assumed to approach


def pick_rays(angle: FloatArray) -> IntArray:
    """Return the index (7,) of the ray (R,) [rad] nearest to each of `DIRECTIONS`.

    Of equally near rays, it is the first.
    """
    apart = np.abs(angle[None, :] - np.deg2rad(DIRECTIONS)[:, None])
    nearest: IntArray = np.argmin(np.round(apart, 9), axis=1).astype(np.int64)
    return nearest


def situations(observation: Observation, speed: FloatArray, tolerance: FloatArray) -> IntArray:
    """Return the situation (B, A) of every agent; 0 if it is inactive.

    Args:
        observation: with rays.
        speed: (B, A) preferred speed [m/s].
        tolerance: (B, A) [m] within which the goal counts as reached.
    """
    out = np.zeros(observation.active.shape, np.int64)
    rays = observation.rays
    if rays is not None:
        encode(
            observation.active, observation.position, observation.heading, observation.goal,
            speed, tolerance, pick_rays(rays.angle), rays.angle, rays.distance, rays.kind,
            rays.approach, out,
        )  # fmt: skip
    return out


@kernel
def encode(
    active: BoolArray, position: FloatArray, heading: FloatArray, goal: FloatArray,
    speed: FloatArray, tolerance: FloatArray, pick: IntArray, angle: FloatArray,
    distance: FloatArray, kind: ByteArray, approach: FloatArray, out: IntArray,
) -> None:  # fmt: skip
    """Fill ``out`` (B, A) for active agents; arrays as in an observation."""
    way = np.empty(7)
    for b in range(active.shape[0]):
        for i in range(active.shape[1]):
            if not active[b, i]:
                continue
            c, s = cos_sin(heading[b, i])
            dx, dy = goal[b, i, 0] - position[b, i, 0], goal[b, i, 1] - position[b, i, 1]
            gx, gy = c * dx + s * dy, c * dy - s * dx
            pace = max(speed[b, i], 1e-6)
            nearest, mover = _WARY, 0
            for k in range(7):
                r = pick[k]
                d, hit = distance[b, i, r], kind[b, i, r]
                way[k] = seconds(gx, gy, angle[r], d, hit, approach[b, i, r], tolerance[b, i], pace)
                if hit in (_AGENT, _MOVER) and way[k] < nearest:
                    nearest, mover = way[k], 1 + (k > 1) + (k > 4)
            far = 1 if gx * gx + gy * gy > (_NEAR * pace) ** 2 else 0
            out[b, i] = number(angle_of(gx, gy), far, way, mover)


@kernel
def seconds(
    gx: float, gy: float, angle: float, distance: float, hit: int, approach: float,
    tolerance: float, pace: float,
) -> float:  # fmt: skip
    """Return the time [s] along a ray to its hit; inf if the goal (gx, gy) [m] is nearer."""
    c, s = cos_sin(angle)
    along, across = gx * c + gy * s, gy * c - gx * s
    half = tolerance * tolerance - across * across
    if along > 0.0 and half > 0.0 and along - math.sqrt(half) <= distance:
        return math.inf
    if hit == _MOVER:
        distance -= _LEAD * max(approach, 0.0)
    return distance / pace


@kernel
def number(bearing: float, far: int, way: FloatArray, mover: int) -> int:
    """Return the mixed-radix number of a situation, digits as in `LEVELS`."""
    code = level(bearing, _BEARING)
    code = code * 2 + far
    code = code * 5 + level(way[3], _AHEAD)
    code = code * 4 + level(way[4], _OBLIQUE)
    code = code * 4 + level(way[2], _OBLIQUE)
    code = code * 3 + level(min(way[5], 2.0 * way[6]), _ASIDE)
    code = code * 3 + level(min(way[1], 2.0 * way[0]), _ASIDE)
    return int(code * 4 + mover)


@kernel
def level(value: float, edges: FloatArray) -> int:
    """Return how many of the ascending ``edges`` the value has reached."""
    n = 0
    for k in range(len(edges)):
        n += value >= edges[k]
    return n
