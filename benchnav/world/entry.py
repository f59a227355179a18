"""The entry of agents that come later than t = 0: each waits until its start is free."""

from typing import Any

import numpy as np

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel_without_allocation
from benchnav.world.touch import encloses

SOON = 1e-9  # [s] a time of entry is reached this much earlier, so that rounding does not decide
_ACTIVE, _WAITING = int(Status.ACTIVE), int(Status.WAITING)


def queue(enters: FloatArray) -> IntArray:
    """Return the agents (A,) in the order in which they enter: by time [s], then by index."""
    return np.argsort(enters, kind="stable")


@kernel_without_allocation
def admit(world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray) -> None:
    """Let the agents enter whose time has come and whose start is free, in the order of the queue.

    An agent whose start is occupied does not hold up the others.
    """
    now = world.steps_done * world.dt + SOON
    for n in range(world.agents):
        a = agents[agents[n].queued]
        if a.enters > now:
            break
        if a.status == _WAITING and _is_free(a, world, agents, bodies, shapes):
            a.status, a.present = _ACTIVE, True
            world.waiting -= 1


@kernel_without_allocation
def _is_free(a: Any, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray) -> bool:
    """Whether the circle around agent a overlaps no other agent's circle, and no body."""
    for j in range(world.agents):
        b = agents[j]
        if b.present and _within(a.x - b.x, a.y - b.y, a.radius + b.radius):
            return False
    for m in range(world.bodies):
        body = bodies[m]
        fx, fy = a.x - body.x, a.y - body.y
        if not _within(fx, fy, a.radius + body.bound):
            continue
        if encloses(body, shapes, a.x, a.y):
            return False
        for q in range(body.first, body.last):
            c = shapes[q]
            qx, qy = nearest_on_segment(fx, fy, c.x0, c.y0, c.x1, c.y1)
            if _within(fx - qx, fy - qy, a.radius + c.r):
                return False
    return True


@kernel_without_allocation
def _within(dx: float, dy: float, reach: float) -> bool:
    return bool(dx * dx + dy * dy < reach * reach)
