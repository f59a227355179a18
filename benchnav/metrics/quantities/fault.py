"""The speeds at which agents move into partners of their contacts: a kernel."""

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.solid import Kind
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.geometry.rotation import cos_sin
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
    executed command, along the normal of the touch; the other part of the closing speed is the
    partner's.
    """
    world, c = episode.world, episode.contacts
    speed = np.zeros(len(rows))
    if len(episode.executed) == 0:
        return speed
    twist = world.agents.dynamics != int(Dynamics.HOLONOMIC)
    if episode.twist is not None:
        twist = twist | episode.twist
    write_own_approach(
        c.agent[rows], c.partner[rows], c.start[rows], world.clock.dt, episode.position,
        episode.heading, episode.executed, twist, shapes_of(world.agents), episode.body_position,
        speed,
    )  # fmt: skip
    return speed


@kernel
def write_own_approach(
    agent: IntArray, partner: IntArray, start: FloatArray, dt: float, position: FloatArray,
    heading: FloatArray, executed: FloatArray, twist: BoolArray, shape: FloatArray,
    body_position: FloatArray, speed: FloatArray,
) -> None:  # fmt: skip
    """Write the own speeds (N,) of contacts: partner ≥ 0 is an agent, -1 - m a body."""
    for n in range(len(agent)):
        a, b = agent[n], partner[n]
        k = min(int(start[n] / dt + 1e-9), len(executed) - 1)
        since = min(max(start[n] - k * dt, 0.0), dt)
        x, y, angle, vx, vy = _touching(a, k, since, position, heading, executed, twist)
        other = (0.0, 0.0, 0.0, 0.0)
        if b >= 0:
            u, v, turned, _, _ = _touching(b, k, since, position, heading, executed, twist)
            c, s = cos_sin(turned)
            other = (shape[b, 0] * c, shape[b, 0] * s, -shape[b, 1] * s, shape[b, 1] * c)
        else:
            u, v = _body_at(-1 - b, k, since / dt, body_position)
        c, s = cos_sin(angle)
        gx = (shape[a, 0] * c, -shape[a, 1] * s, other[0], other[2])
        gy = (shape[a, 0] * s, shape[a, 1] * c, other[1], other[3])
        nx, ny, _ = distance_to_sum(x - u, y - v, gx, gy)
        length = np.sqrt(nx * nx + ny * ny)
        if length > 0.0:
            speed[n] = -(nx * vx + ny * vy) / length


@kernel_without_allocation
def _touching(
    a: int, k: int, since: float, position: FloatArray, heading: FloatArray,
    executed: FloatArray, twist: BoolArray,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """Return place, heading and velocity of agent a, ``since`` [s] after state k, by its command.

    A twist drives an arc, whose chord is along its mid-heading.
    """
    x, y, angle = position[k, a, 0], position[k, a, 1], heading[k, a]
    vx, vy = executed[k, a, 0], executed[k, a, 1]
    if not twist[a]:
        return x + vx * since, y + vy * since, angle, vx, vy
    forward, rate = vx, vy
    c, s = cos_sin(angle + 0.5 * rate * since)
    x, y = x + forward * c * since, y + forward * s * since
    angle += rate * since
    c, s = cos_sin(angle)
    return x, y, angle, forward * c, forward * s


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
