"""Optimal reciprocal collision avoidance for every agent of a batch.

Rows N are (world, agent) pairs, run by `benchnav.threads.run_rows`, and independent of
each other. Arrays are plain arguments, because Numba counts references
to the members of a tuple on every access.
"""

import math

import numpy as np

from benchnav.arena import Dynamics, Kind
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry import cos_sin
from benchnav.kernels import kernel, kernel_without_allocation

from ...common.car import BACK_TURN, car_direction
from ...common.motion_limits import BACKWARDS, KIND
from .half_plane import covers, edge_half_plane, neighbour_half_plane
from .program import least_excess, nearest_permitted
from .trackable import MOST, trackable, tracking_error, widest_turn

_HOLONOMIC, _CAR = float(Dynamics.HOLONOMIC), float(Dynamics.ACKERMANN)
BLOCKED = 0.05  # share of the preferred speed: a slower car, if it can, drives backwards
STILL_BLOCKED = 0.3  # the same for a car that drives backwards already
LEAST_ERROR = 0.03  # [m] ε of a body that is close to an object
_MOVER = int(Kind.DYNAMIC)
OWN = 9  # columns: x, y, vx, vy, preferred vx, preferred vy, radius, speed limit, 1 / step


@kernel_without_allocation
def prepare(
    low: int, high: int, position: FloatArray, velocity: FloatArray, target: FloatArray,
    limits: FloatArray, offset: FloatArray, own: FloatArray,
) -> None:  # fmt: skip
    """Fill rows low … high - 1 of ``own`` (N, 9), see `OWN`.

    The preferred velocity leads straight to the target, not past it within a step.

    Args:
        low: first row.
        high: one past the last row.
        position: (N, 2) [m].
        velocity: (N, 2) [m/s].
        target: (N, 2) [m].
        limits: (N, 4) radius [m], speed limit, preferred speed [m/s], step [s].
        offset: (N, 2) error of both velocities, as a share of the speeds.
        own: (N, 9).
    """
    for i in range(low, high):
        step = limits[i, 3] if limits[i, 3] > 0.0 else 1.0
        dx, dy = target[i, 0] - position[i, 0], target[i, 1] - position[i, 1]
        distance = math.sqrt(dx * dx + dy * dy)
        speed = min(limits[i, 2], distance / step)
        scale = speed / distance if distance > 0.0 else 0.0
        own[i, 0], own[i, 1] = position[i, 0], position[i, 1]
        own[i, 2] = velocity[i, 0] + limits[i, 2] * offset[i, 0]
        own[i, 3] = velocity[i, 1] + limits[i, 2] * offset[i, 1]
        own[i, 4] = scale * dx + speed * offset[i, 0]
        own[i, 5] = scale * dy + speed * offset[i, 1]
        own[i, 6], own[i, 7], own[i, 8] = limits[i, 0], limits[i, 1], 1.0 / step


@kernel_without_allocation
def edge_rows(
    i: int, px: float, py: float, vx: float, vy: float, radius: float, rate: float,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, count: int, first: int, planes: FloatArray,
) -> int:  # fmt: skip
    """Write the half-planes of agent i's edges from row ``first`` on; return the next free row."""
    n = first
    for k in range(count):
        ax, ay = start[i, k, 0] - px, start[i, k, 1] - py
        bx, by = end[i, k, 0] - px, end[i, k, 1] - py
        covered = False
        for j in range(first, n):
            row = (planes[j, 0], planes[j, 1], planes[j, 2], planes[j, 3])
            if covers(row, ax, ay, bx, by, radius, rate):
                covered = True
                break
        if covered:
            continue
        made, row = edge_half_plane(
            ax, ay, bx, by,
            before[i, k, 0], before[i, k, 1], after[i, k, 0], after[i, k, 1],
            start_convex[i, k], end_convex[i, k], vx, vy, radius, rate,
        )  # fmt: skip
        if made:
            planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = row
            n += 1
    return n


@kernel
def avoid(
    low: int, high: int, own: FloatArray, active: BoolArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, edge_count: IntArray,
    most: int, margin: float, edge_margin: FloatArray, rate: float, edge_rate: float,
    answer: FloatArray,
) -> None:  # fmt: skip
    """Write new velocities [m/s] into rows low … high - 1 of ``answer`` (N, 2).

    Rows of inactive agents are not changed.

    Args:
        low: first row.
        high: one past the last row.
        own: (N, 9) see `OWN`.
        active: (N,).
        position: (N, K, 2) of neighbours [m], nearest first.
        velocity: (N, K, 2) [m/s].
        radius: (N, K) [m].
        kind: (N, K) Kind.AGENT shares the effort, Kind.DYNAMIC leaves it to the agent.
        count: (N,) valid neighbours.
        start: (N, E, 2) of edges [m], nearest first, solid to the left.
        end: (N, E, 2) [m].
        before: (N, E, 2) unit direction of the previous edge.
        after: (N, E, 2) unit direction of the next edge.
        start_convex: (N, E).
        end_convex: (N, E).
        edge_count: (N,) valid edges.
        most: largest number of neighbours to use.
        margin: [m] added to every disc beside neighbours.
        edge_margin: (N,) [m] added to the agent's own disc at edges.
        rate: 1 / time horizon for neighbours [1/s].
        edge_rate: 1 / time horizon for edges [1/s].
        answer: (N, 2).
    """
    size = position.shape[1] + start.shape[1]
    planes, projected = np.empty((size, 4)), np.empty((size, 4))
    for i in range(low, high):
        if active[i]:
            _avoid_row(
                i, own, position, velocity, radius, kind, count, start, end, before, after,
                start_convex, end_convex, edge_count, most, margin, edge_margin, rate, edge_rate,
                0, answer, planes, projected,
            )  # fmt: skip


@kernel
def avoid_within_limits(
    low: int, high: int, own: FloatArray, active: BoolArray, heading: FloatArray,
    target: FloatArray, limits: FloatArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, edge_count: IntArray,
    most: int, margin: float, edge_margin: FloatArray, rate: float, edge_rate: float,
    error: float, answer: FloatArray,
) -> None:  # fmt: skip
    """Write velocities [m/s] that bodies with limits can track, like `avoid`.

    Args:
        low: first row.
        high: one past the last row.
        own: (N, 9) see `OWN`; radii are enlarged.
        active: (N,).
        heading: (N,) [rad].
        target: (N, 2) [m] where the preferred velocity leads.
        limits: (N, 13) see `baselines.common.motion_limits`.
        position: (N, K, 2) as in `avoid`, like all arguments from here to ``edge_rate``.
        velocity: (N, K, 2).
        radius: (N, K).
        kind: (N, K).
        count: (N,).
        start: (N, E, 2).
        end: (N, E, 2).
        before: (N, E, 2).
        after: (N, E, 2).
        start_convex: (N, E).
        end_convex: (N, E).
        edge_count: (N,).
        most: see `avoid`.
        margin: [m].
        edge_margin: (N,) [m]; reduced by the enlargement.
        rate: [1/s].
        edge_rate: [1/s].
        error: [m] the largest tracking error; less near other objects.
        answer: (N, 2).
    """
    size = MOST + position.shape[1] + start.shape[1]
    planes, projected = np.empty((size, 4)), np.empty((size, 4))
    for i in range(low, high):
        if not active[i]:
            continue
        strays = tracking_error(
            own[i, 0], own[i, 1], own[i, 6], position[i], radius[i], min(count[i], most),
            start[i], end[i], edge_count[i], LEAST_ERROR, error,
        )  # fmt: skip
        backwards, blocked = False, 0.0
        if limits[i, KIND] != _HOLONOMIC:
            backwards, blocked = _chosen_way(
                own[i], heading[i], target[i, 0], target[i, 1], limits[i], strays
            )
        own[i, 6] += strays
        edge_margin[i] = max(edge_margin[i] - strays, 0.0)
        for _ in range(2):
            course = heading[i] + math.pi if backwards else heading[i]
            hard = trackable(limits[i], course, own[i, 2], own[i, 3], strays, planes)
            _avoid_row(
                i, own, position, velocity, radius, kind, count, start, end, before, after,
                start_convex, end_convex, edge_count, most, margin, edge_margin, rate, edge_rate,
                hard, answer, planes, projected,
            )  # fmt: skip
            if backwards or answer[i, 0] ** 2 + answer[i, 1] ** 2 >= blocked * blocked:
                break
            backwards = True  # a car with no way ahead: back, with its front turning to the target
            _turn_back(own[i], heading[i], target[i, 0], target[i, 1])


@kernel
def _chosen_way(
    own: FloatArray, heading: float, tx: float, ty: float, limits: FloatArray, error: float
) -> tuple[bool, float]:
    """Return (backwards, speed [m/s] below which its way counts as blocked, 0: never).

    The preferred velocity of a car is turned to a direction that it can take.
    """
    c, s = cos_sin(heading)
    if limits[KIND] != _CAR:
        return limits[BACKWARDS] > 0.0 and c * own[4] + s * own[5] < 0.0, 0.0
    ahead = c * own[2] + s * own[3]
    backwards, direction = car_direction(
        limits, own[0], own[1], heading, ahead, tx, ty, widest_turn(limits, abs(ahead), error)
    )
    speed = math.sqrt(own[4] * own[4] + own[5] * own[5])
    dc, ds = cos_sin(direction)
    own[4], own[5] = speed * dc, speed * ds
    blocked = 0.0
    if limits[BACKWARDS] > 0.0:
        blocked = speed * (STILL_BLOCKED if ahead < 0.0 else BLOCKED)
    return backwards, blocked


@kernel
def _turn_back(own: FloatArray, heading: float, tx: float, ty: float) -> None:
    """Turn the preferred velocity of a car backwards, so that its front turns to the target."""
    c, s = cos_sin(heading)
    aside = c * (ty - own[1]) - s * (tx - own[0])
    speed = math.sqrt(own[4] * own[4] + own[5] * own[5])
    bc, bs = cos_sin(heading + math.pi + math.copysign(BACK_TURN, aside))
    own[4], own[5] = speed * bc, speed * bs


@kernel_without_allocation
def _avoid_row(
    i: int, own: FloatArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
    start: FloatArray, end: FloatArray, before: FloatArray, after: FloatArray,
    start_convex: BoolArray, end_convex: BoolArray, edge_count: IntArray,
    most: int, margin: float, edge_margin: FloatArray, rate: float, edge_rate: float,
    hard: int, answer: FloatArray, planes: FloatArray, projected: FloatArray,
) -> None:  # fmt: skip
    """Write the velocity of row i; the first ``hard`` rows of ``planes`` limit it already."""
    px, py, vx, vy, wx, wy = own[i, 0], own[i, 1], own[i, 2], own[i, 3], own[i, 4], own[i, 5]
    own_radius, speed, step_rate = own[i, 6], own[i, 7], own[i, 8]
    n = hard
    if edge_count[i] > 0:
        n = edge_rows(
            i, px, py, vx, vy, own_radius + edge_margin[i], edge_rate, start, end, before,
            after, start_convex, end_convex, edge_count[i], hard, planes,
        )  # fmt: skip
    fixed = n
    for k in range(min(count[i], most)):
        row = neighbour_half_plane(
            position[i, k, 0] - px, position[i, k, 1] - py,
            vx - velocity[i, k, 0], vy - velocity[i, k, 1], vx, vy,
            own_radius + margin + margin + radius[i, k], rate, step_rate,
            1.0 if kind[i, k] == _MOVER else 0.5,
        )  # fmt: skip
        planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = row
        n += 1
    reached, x, y = nearest_permitted(planes, n, speed, wx, wy, False)
    if hard > 0 and reached < fixed:
        fixed = hard  # no velocity that it can track keeps off all edges
    if reached < n:
        x, y = least_excess(planes, n, fixed, reached, speed, x, y, projected)
    answer[i, 0], answer[i, 1] = x, y
