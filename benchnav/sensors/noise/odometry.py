"""The error of the own pose, and the frame in which an agent believes itself to be.

The odometry frame is the world frame at the start of an episode. The agent's estimate p̂, θ̂ of its
pose p, θ drifts with the way that it drives, so the frame moves: a point q that is sensed from p
seems to be at p̂ + R(φ) (q - p), with φ = θ̂ - θ. The goal and the map keep their numbers in it.

The drift is a random walk: a variance grows in proportion to the path or the turn, so it does not
depend on the time step (Siegwart and Nourbakhsh, Introduction to Autonomous Mobile Robots, 2004,
section 5.2.4, for any kind of body). The random numbers depend on the decision only.
"""

import math

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.geometry.rotation import cos_sin, wrap
from benchnav.kernels import kernel_without_allocation
from benchnav.sensors.noise.draws import CORRECTION, ODOMETRY, draw, two_normals

X, Y, HEADING = range(3)  # columns of a pose and of its error


@kernel_without_allocation
def drift(
    low: int, high: int, chosen: IntArray, worlds: AnyArray, agents: AnyArray, keys: AnyArray,
    along: float, per_metre: float, per_turn: float, period: int, position_noise: float,
    heading_noise: float, error: FloatArray, last: FloatArray, done: IntArray,
) -> None:  # fmt: skip
    """Advance the ``error`` (B, An, 3) of the poses of rows low:high to the current decision.

    Args:
        low: first row.
        high: row behind the last one.
        chosen: (B, An) indices of agents, -1: padding.
        worlds: (B,) records.
        agents: (B, A) records.
        keys: (B, 2) of uint64.
        along: [m] deviation along the path after 1 m.
        per_metre: [rad] deviation of the heading after 1 m.
        per_turn: [rad] deviation of the heading after a turn by 1 rad.
        period: decisions between corrections; 0: there are none.
        position_noise: [m] deviation of each coordinate of a correction.
        heading_noise: [rad] deviation of the heading of a correction.
        error: x, y [m] and heading [rad] of the estimate, minus those of the agent.
        last: (B, An, 3) true poses at the last call.
        done: (B,) decisions at the last call; -1: a world starts, without error.
    """
    for b in range(low, high):
        step = worlds[b].steps_done
        if step == done[b]:
            continue
        for k in range(chosen.shape[1]):
            i = chosen[b, k]
            if i < 0:
                continue
            a, e = agents[b, i], error[b, k]
            if done[b] < 0:
                e[X], e[Y], e[HEADING] = 0.0, 0.0, 0.0
            elif period > 0 and step % period == 0:
                first, second = draw(keys[b, 0], keys[b, 1], step, i, CORRECTION, 0)
                nx, ny = two_normals(first)
                turn, _ = two_normals(second)
                e[X], e[Y] = position_noise * nx, position_noise * ny
                e[HEADING] = heading_noise * turn
            else:
                dx, dy = a.x - last[b, k, X], a.y - last[b, k, Y]
                way = math.sqrt(dx * dx + dy * dy)
                turned = abs(wrap(a.heading - last[b, k, HEADING]))
                first, _ = draw(keys[b, 0], keys[b, 1], step, i, ODOMETRY, 0)
                slip, turn = two_normals(first)
                turn *= math.sqrt(per_metre * per_metre * way + per_turn * per_turn * turned)
                c, s = cos_sin(e[HEADING] + 0.5 * turn)
                stretch = 1.0 + along * slip / math.sqrt(way) if way > 0.0 else 1.0
                e[X] += stretch * (c * dx - s * dy) - dx
                e[Y] += stretch * (s * dx + c * dy) - dy
                e[HEADING] += turn
            last[b, k, X], last[b, k, Y], last[b, k, HEADING] = a.x, a.y, a.heading
        done[b] = step


@kernel_without_allocation
def is_exact(e: FloatArray) -> bool:
    """Whether an error (3,) is zero. Then nothing is turned, so that no bit changes."""
    return bool(e[X] == 0.0 and e[Y] == 0.0 and e[HEADING] == 0.0)


@kernel_without_allocation
def placed(
    x: float, y: float, own_x: float, own_y: float, c: float, s: float, e: FloatArray
) -> tuple[float, float]:
    """Return where the point (x, y) seems to be to an agent with error ``e``, turned by (c, s)."""
    dx, dy = x - own_x, y - own_y
    return own_x + e[X] + (c * dx - s * dy), own_y + e[Y] + (s * dx + c * dy)


@kernel_without_allocation
def estimate_own_state(
    low: int, high: int, chosen: IntArray, error: FloatArray, position: FloatArray,
    heading: FloatArray, velocity: FloatArray,
) -> None:  # fmt: skip
    """Replace true states (B, An, …) of rows low:high by their estimates."""
    for b in range(low, high):
        for k in range(chosen.shape[1]):
            e = error[b, k]
            if chosen[b, k] < 0 or is_exact(e):
                continue
            c, s = cos_sin(e[HEADING])
            vx, vy = velocity[b, k, 0], velocity[b, k, 1]
            position[b, k, 0] += e[X]
            position[b, k, 1] += e[Y]
            heading[b, k] = wrap(heading[b, k] + e[HEADING])
            velocity[b, k, 0], velocity[b, k, 1] = c * vx - s * vy, s * vx + c * vy


@kernel_without_allocation
def turn_back(low: int, high: int, rows: IntArray, error: FloatArray, velocity: FloatArray) -> None:
    """Turn velocities low:high of (N, An, 2) of the worlds ``rows`` (N,) into the world frame."""
    for n in range(low, high):
        for k in range(velocity.shape[1]):
            turned = error[rows[n], k, HEADING]
            if turned == 0.0:
                continue
            c, s = cos_sin(turned)
            vx, vy = velocity[n, k, 0], velocity[n, k, 1]
            velocity[n, k, 0], velocity[n, k, 1] = c * vx + s * vy, c * vy - s * vx
