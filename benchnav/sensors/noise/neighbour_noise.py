"""Errors of neighbours: position, velocity, misses, false alarms and field of view."""

import math

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.rotation import TWO_PI, cos_sin, wrap
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.sensors.noise.draws import (
    FALSE_ALARM,
    MISSED_NEIGHBOUR,
    NEIGHBOUR,
    draw,
    two_normals,
    uniform,
)
from benchnav.sensors.noise.odometry import HEADING, is_exact, placed
from benchnav.sensors.noise.ray_noise import in_view

_AGENT = int(Kind.AGENT)
PX, PY, VX, VY, RADIUS, KIND, FAR, TURN = range(8)  # of a reading; FAR: squared distance
LENGTH, WIDTH, ROUNDING = range(8, 11)  # of a shape, whose heading is TURN; all 0: a disc
COLUMNS = 11


@kernel
def disturb_neighbours(
    low: int, high: int, chosen: IntArray, limit: float, position_noise: float,
    velocity_noise: float, missed: float, false_alarms: float, view: float, worlds: AnyArray,
    agents: AnyArray, keys: AnyArray, error: FloatArray, identity: IntArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, heading: FloatArray,
    half_length: FloatArray, half_width: FloatArray, rounding: FloatArray, count: IntArray,
) -> None:  # fmt: skip
    """Add noise to the readings of rows low:high of the flattened (B, chosen agents).

    They stay sorted by distance. The errors of a neighbour depend on its ``identity``, not on its
    place in the list. A false alarm is a standing disc like the agent itself, anywhere in range and
    in view. The other arguments are those of `find_neighbours`, and the numbers of
    `NeighbourNoise`.
    """
    readings = np.zeros((position.shape[2] + 1, COLUMNS))
    _disturb_rows(
        low, high, chosen, limit, position_noise, velocity_noise, missed, false_alarms, view,
        worlds, agents, keys, error, identity, position, velocity, radius, kind, heading,
        half_length, half_width, rounding, count, readings,
    )  # fmt: skip


@kernel_without_allocation
def _disturb_rows(
    low: int, high: int, chosen: IntArray, limit: float, position_noise: float,
    velocity_noise: float, missed: float, false_alarms: float, view: float, worlds: AnyArray,
    agents: AnyArray, keys: AnyArray, error: FloatArray, identity: IntArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, heading: FloatArray,
    half_length: FloatArray, half_width: FloatArray, rounding: FloatArray, count: IntArray,
    readings: FloatArray,
) -> None:  # fmt: skip
    width, most = chosen.shape[1], position.shape[2]
    everywhere, (cos_half, _) = view >= TWO_PI, cos_sin(0.5 * view)
    for row in range(low, high):
        b, k = row // width, row % width
        i = chosen[b, k]
        if i < 0 or not agents[b, i].present:
            continue
        a, e, step = agents[b, i], error[b, k], worlds[b].steps_done
        ca, sa = cos_sin(a.heading)
        n = 0
        for s in range(count[b, k]):
            x, y = position[b, k, s, 0], position[b, k, s, 1]
            vx, vy, name = velocity[b, k, s, 0], velocity[b, k, s, 1], identity[b, k, s]
            if not everywhere and not in_view(x - a.x, y - a.y, ca, sa, cos_half):
                continue
            if missed > 0.0:
                first, _ = draw(keys[b, 0], keys[b, 1], step, i, MISSED_NEIGHBOUR, name)
                if uniform(first) < missed:
                    continue
            first, second = draw(keys[b, 0], keys[b, 1], step, i, NEIGHBOUR, name)
            if position_noise > 0.0:
                nx, ny = two_normals(first)
                x, y = x + position_noise * nx, y + position_noise * ny
            if velocity_noise > 0.0:
                nx, ny = two_normals(second)
                vx, vy = vx + velocity_noise * nx, vy + velocity_noise * ny
            far = (x - a.x) * (x - a.x) + (y - a.y) * (y - a.y)
            if n > 0 and position_noise == 0.0:
                far = max(far, readings[n - 1, FAR])  # the order of the sensor, whatever rounding
            at = _insert(n, x, y, vx, vy, radius[b, k, s], float(kind[b, k, s]), far, readings)
            readings[at, TURN], readings[at, LENGTH] = heading[b, k, s], half_length[b, k, s]
            readings[at, WIDTH], readings[at, ROUNDING] = half_width[b, k, s], rounding[b, k, s]
            n += 1
        if false_alarms > 0.0:
            first, second = draw(keys[b, 0], keys[b, 1], step, i, FALSE_ALARM, 0)
            if uniform(first) < false_alarms:
                towards_x, towards_y = cos_sin(a.heading + (uniform(second) - 0.5) * view)
                first, second = draw(keys[b, 0], keys[b, 1], step, i, FALSE_ALARM, 1)
                away = limit * math.sqrt(uniform(first))
                nx, ny = two_normals(second)
                x, y = a.x + away * towards_x, a.y + away * towards_y
                vx, vy = velocity_noise * nx, velocity_noise * ny
                at = _insert(n, x, y, vx, vy, a.radius, float(_AGENT), away * away, readings)
                readings[at, TURN:] = 0.0
                n += 1
        n = min(n, most)
        _write(
            n, a.x, a.y, e, readings, position[b, k], velocity[b, k], radius[b, k], kind[b, k],
            heading[b, k], half_length[b, k], half_width[b, k], rounding[b, k],
        )  # fmt: skip
        count[b, k] = n


@kernel_without_allocation
def _insert(
    n: int, x: float, y: float, vx: float, vy: float, radius: float, kind: float, far: float,
    readings: FloatArray,
) -> int:  # fmt: skip
    """Insert a reading into n sorted ones, behind those that are as far; return its place."""
    at = n
    while at > 0 and readings[at - 1, FAR] > far:
        for column in range(COLUMNS):
            readings[at, column] = readings[at - 1, column]
        at -= 1
    reading = readings[at]
    reading[PX], reading[PY], reading[VX], reading[VY] = x, y, vx, vy
    reading[RADIUS], reading[KIND], reading[FAR] = radius, kind, far
    return at


@kernel_without_allocation
def _write(
    n: int, own_x: float, own_y: float, e: FloatArray, readings: FloatArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, heading: FloatArray,
    half_length: FloatArray, half_width: FloatArray, rounding: FloatArray,
) -> None:  # fmt: skip
    """Write n readings in the odometry frame; zero behind them."""
    exact, (c, s) = is_exact(e), cos_sin(e[HEADING])
    for at in range(len(radius)):
        reading = readings[at]
        if at >= n:
            reading[:] = 0.0
        elif not exact:
            vx, vy = reading[VX], reading[VY]
            reading[PX], reading[PY] = placed(reading[PX], reading[PY], own_x, own_y, c, s, e)
            reading[VX], reading[VY] = c * vx - s * vy, s * vx + c * vy
            if reading[LENGTH] > 0.0:
                reading[TURN] = wrap(reading[TURN] + e[HEADING])
        position[at, 0], position[at, 1] = reading[PX], reading[PY]
        velocity[at, 0], velocity[at, 1] = reading[VX], reading[VY]
        radius[at], kind[at] = reading[RADIUS], int(reading[KIND])
        heading[at], half_length[at] = reading[TURN], reading[LENGTH]
        half_width[at], rounding[at] = reading[WIDTH], reading[ROUNDING]
