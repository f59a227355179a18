"""The speeds at which agents move into partners of their contacts: a kernel."""

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.solid import Kind
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.geometry.rotation import cos_sin, wrap
from benchnav.geometry.segment_sum import distance_to_sum
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.metrics.quantities.footprint_gaps import shapes_of
from benchnav.world.bodies import is_away


def with_people(episode: Episode) -> BoolArray:
    """Return the mask (N,) of contacts of evaluated agents with people."""
    c, world = episode.contacts, episode.world
    agents, bodies = world.people
    agent = (c.kind == int(Kind.AGENT)) & np.isin(c.partner, agents)
    body = (c.kind == int(Kind.DYNAMIC)) & np.isin(c.partner, -1 - bodies)
    return np.asarray((agent | body) & world.agents.evaluated[c.agent])


def own_approach(episode: Episode, rows: IntArray) -> FloatArray:
    """Return (N,) [m/s] the agent's own speed towards its partner at the first touch.

    ``rows`` (N,) selects contacts with agents or dynamic obstacles. The own speed is that of the
    executed command at the point of the touch, along its normal; the rest of the closing speed
    is the partner's.
    """
    world, c = episode.world, episode.contacts
    speed = np.zeros(len(rows))
    if len(episode.executed) == 0:
        return speed
    twist = world.agents.dynamics != int(Dynamics.HOLONOMIC)
    if episode.twist is not None:
        twist = twist | episode.twist
    size = np.array([body.solid.bounding_radius for body in world.bodies], np.float64)
    write_own_approach(
        c.agent[rows], c.partner[rows], c.start[rows], world.clock.dt, world.clock.substeps,
        episode.position, episode.heading, episode.executed, twist, shapes_of(world.agents),
        episode.body_position, size, speed,
    )  # fmt: skip
    return speed


@kernel
def write_own_approach(
    agent: IntArray, partner: IntArray, start: FloatArray, dt: float, substeps: int,
    position: FloatArray, heading: FloatArray, executed: FloatArray, twist: BoolArray,
    shape: FloatArray, body_position: FloatArray, size: FloatArray, speed: FloatArray,
) -> None:  # fmt: skip
    """Write the own speeds (N,) of contacts: partner ≥ 0 is an agent, -1 - m a body."""
    h = dt / substeps
    for n in range(len(agent)):
        a, b = agent[n], partner[n]
        k = min(int(start[n] / dt + 1e-9), len(executed) - 1)
        since = min(max(start[n] - k * dt, 0.0), dt)
        motion = heading, executed, twist
        x, y, angle, vx, vy, rate = _touching(a, k, since, dt, h, position, *motion)
        other, radius = (0.0, 0.0, 0.0, 0.0), 0.0
        if b >= 0:
            u, v, turned, _, _, _ = _touching(b, k, since, dt, h, position, *motion)
            c, s = cos_sin(turned)
            other = (shape[b, 0] * c, shape[b, 0] * s, -shape[b, 1] * s, shape[b, 1] * c)
            radius = shape[b, 2]
        else:
            u, v = _body_at(-1 - b, k, since / dt, body_position)
            radius = size[-1 - b]
        c, s = cos_sin(angle)
        gx = (shape[a, 0] * c, -shape[a, 1] * s, other[0], other[2])
        gy = (shape[a, 0] * s, shape[a, 1] * c, other[1], other[3])
        nx, ny, _ = distance_to_sum(x - u, y - v, gx, gy)
        length = np.sqrt(nx * nx + ny * ny)
        if length > 0.0:
            nx, ny = nx / length, ny / length
            arm_x, arm_y = u + radius * nx - x, v + radius * ny - y
            speed[n] = -(nx * (vx - rate * arm_y) + ny * (vy + rate * arm_x))


@kernel_without_allocation
def _touching(
    a: int, k: int, since: float, dt: float, h: float, position: FloatArray,
    heading: FloatArray, executed: FloatArray, twist: BoolArray,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """Return place, heading, velocity and turn rate of agent a, ``since`` [s] after state k.

    As in the simulator, a twist drives each substep of ``h`` [s] along its mid-heading.
    """
    x, y, angle = position[k, a, 0], position[k, a, 1], heading[k, a]
    vx, vy = executed[k, a, 0], executed[k, a, 1]
    if not twist[a]:
        rate = wrap(heading[k + 1, a] - angle) / dt
        return x + vx * since, y + vy * since, angle + rate * since, vx, vy, rate
    forward, rate, left = vx, vy, since
    while True:
        c, s = cos_sin(angle + 0.5 * rate * h)
        vx, vy = forward * c, forward * s
        x += vx * min(left, h)
        y += vy * min(left, h)
        if left <= h:
            return x, y, angle + rate * left, vx, vy, rate
        left -= h
        angle += rate * h


@kernel_without_allocation
def _body_at(m: int, k: int, share: float, position: FloatArray) -> tuple[float, float]:
    """Return the place [m] of body m at a share of the step after state k."""
    x, y = position[k, m, 0], position[k, m, 1]
    u, v = position[k + 1, m, 0], position[k + 1, m, 1]
    if is_away(x, y):
        return u, v
    if is_away(u, v):
        return x, y
    return x + (u - x) * share, y + (v - y) * share
