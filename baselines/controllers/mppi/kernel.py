"""One decision of model predictive path integral control, for every agent of a batch.

Rows N are (world, agent) pairs and independent of each other. See `weights` for the
source.
"""

import math

import numpy as np

from benchnav.arena import Dynamics
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.kernels import kernel

from ...common.car import car_target
from ...common.motion_limits import KIND, reach_in_turn
from .cost import cost_of, edge_distances
from .weights import disturbed, moved_on, weigh

_CAR = float(Dynamics.ACKERMANN)
LEAST = 1e-3  # [m] by which a body with limits may come nearer to an edge


@kernel
def gathered(
    i: int, x: float, y: float, way: float, time: float, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: int,
    p: FloatArray, u: FloatArray, r: FloatArray, kinds: ByteArray,
) -> int:  # fmt: skip
    """Copy the neighbours of row i that could be met within ``time``; return their number."""
    n = 0
    for j in range(count):
        dx, dy = position[i, j, 0] - x, position[i, j, 1] - y
        vx, vy = velocity[i, j, 0], velocity[i, j, 1]
        reach = way + radius[i, j] + math.sqrt(vx * vx + vy * vy) * time
        if dx * dx + dy * dy < reach * reach:
            p[n, 0], p[n, 1] = position[i, j, 0], position[i, j, 1]
            u[n, 0], u[n, 1] = vx, vy
            r[n], kinds[n] = radius[i, j], kind[i, j]
            n += 1
    return n


@kernel
def leaving(base: FloatArray, plan: FloatArray, sigma: FloatArray) -> float:
    """Return Σ uᵀ Σ⁻¹ ε / H of a plan u + ε about the base u (H, 2): the cost's control term."""
    total = 0.0
    for t in range(len(base)):
        for c in range(2):
            total += base[t, c] * (plan[t, c] - base[t, c]) / (sigma[c] * sigma[c])
    return total / len(base)


@kernel
def averaged(weight: FloatArray, tried: FloatArray, mean: FloatArray) -> None:
    """Set ``mean`` (H, 2) to Σ weight (S,) · tried (S, H, 2)."""
    mean[:] = 0.0
    for k in range(len(weight)):
        if weight[k] > 0.0:
            for t in range(len(mean)):
                mean[t, 0] += weight[k] * tried[k, t, 0]
                mean[t, 1] += weight[k] * tried[k, t, 1]


@kernel
def control(
    low: int, high: int, active: BoolArray, here: FloatArray, heading: FloatArray,
    target: FloatArray, remaining: FloatArray, body: FloatArray, plan: FloatArray,
    limited: BoolArray, limits: FloatArray, steering: FloatArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray, start: FloatArray, end: FloatArray, edges: IntArray, noise: FloatArray,
    tick: float, spread: FloatArray, temperature: float, control_cost: float, margin: float,
    weights: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Write new plans into rows low … high - 1 of ``out`` (N, H, 2); their first twist is executed.

    Args:
        low: first row.
        high: one past the last row.
        active: (N,) rows to write.
        here: (N, 2) [m].
        heading: (N,) [rad].
        target: (N, 2) [m].
        remaining: (N,) [m] of the path.
        body: (N, 6) see `baselines.common.kernel_inputs.BODY`.
        plan: (N, H, 2) the last plans; zero if there is none. Their first twist is the current.
        limited: (N,) whether the body has more limits than speed and turn rate.
        limits: (N, 13) see `baselines.common.motion_limits`.
        steering: (N,) [rad] angle of a car's front wheels.
        position: (N, K, 2) of neighbours [m].
        velocity: (N, K, 2) [m/s].
        radius: (N, K) [m].
        kind: (N, K).
        count: (N,) valid neighbours.
        start: (N, E, 2) of edges [m].
        end: (N, E, 2) [m].
        edges: (N,) valid edges.
        noise: (N, S, M, 2) standard normal: S samples, M knots.
        tick: [s] duration of each twist of a plan.
        spread: (2,) of the noise, as shares of preferred speed and top turn rate.
        temperature: λ [m].
        control_cost: γ / λ: the cost of plans that deviate from the last one.
        margin: [m] within which a contact is counted.
        weights: (7,) see `cost.WEIGHTS`.
        out: (N, H, 2).
    """
    samples, steps, most = noise.shape[1], plan.shape[1], position.shape[1]
    tried, base, mean = np.empty((samples, steps, 2)), np.empty((steps, 2)), np.empty((steps, 2))
    cost, weight = np.empty(samples), np.empty(samples)
    sigma, bottom, top = np.empty(2), np.empty(2), np.empty(2)
    p, u, r, kinds = (
        np.empty((most, 2)),
        np.empty((most, 2)),
        np.empty(most),
        np.empty(most, np.int8),
    )
    far = np.empty(start.shape[1])
    for i in range(low, high):
        if not active[i]:
            continue
        x, y, me, last = here[i, 0], here[i, 1], body[i], plan[i, 0]
        way = me[2] * tick * steps + me[0] + weights[4]
        n = gathered(
            i, x, y, way, tick * steps, position, velocity, radius, kind, count[i], p, u, r, kinds
        )
        edge_distances(x, y, start[i], end[i], edges[i], far)
        gap = margin
        if limited[i]:  # it may leave a place that is nearer to an edge than the margin
            for k in range(edges[i]):
                gap = min(gap, max(2.0 * (far[k] - me[0]) - LEAST, 0.0))
        sigma[0], sigma[1] = spread[0] * me[2], spread[1] * me[3]
        bottom[0], bottom[1], top[0], top[1] = 0.0, -me[3], me[2], me[3]
        gx, gy = target[i, 0], target[i, 1]
        final = remaining[i] <= math.sqrt((gx - x) ** 2 + (gy - y) ** 2) + me[5]
        if limited[i] and limits[i, KIND] == _CAR:
            replaced, gx, gy = car_target(limits[i], x, y, heading[i], last[0], gx, gy, False)
            final = final and not replaced
        moved_on(plan[i], me[4] / tick, base)
        if limited[i]:
            reach_in_turn(base, last[0], last[1], steering[i], limits[i], me[4], tick)
        all_touch, best = True, 0
        for k in range(samples):
            if k == 0:
                tried[k] = base
            elif k == 1:
                tried[k] = 0.0  # an addition: standing still is always a sample
            else:
                disturbed(base, noise[i, k], sigma, bottom, top, tried[k])
            if limited[i] and k > 0:
                reach_in_turn(tried[k], last[0], last[1], steering[i], limits[i], me[4], tick)
            cost[k], touches = cost_of(
                tried[k], tick, x, y, heading[i], last, gx, gy, final, me, gap,
                p, u, r, kinds, n, start[i], end[i], far, edges[i], weights,
            )  # fmt: skip
            cost[k] += control_cost * temperature * leaving(base, tried[k], sigma)
            if cost[k] < cost[best]:
                best = k
            all_touch = all_touch and touches
        weigh(cost, temperature, weight)
        averaged(weight, tried, mean)
        if limited[i]:
            reach_in_turn(mean, last[0], last[1], steering[i], limits[i], me[4], tick)
        _, touches = cost_of(
            mean, tick, x, y, heading[i], last, gx, gy, final, me, gap,
            p, u, r, kinds, n, start[i], end[i], far, edges[i], weights,
        )  # fmt: skip
        # an addition: the mean of paths around both sides of an obstacle leads into it
        out[i] = tried[best] if touches and not all_touch else mean
