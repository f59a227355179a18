"""Contacts of agents that are not discs: a rectangle or segment along the heading, with a radius.

The axis of an agent is a field of its record, and constant within a substep. All functions are
exact for a motion without rotation; see `benchnav.geometry.segment_sum`.
"""

import math
from typing import Any

from benchnav.arrays import AnyArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.rotation import cos_sin
from benchnav.geometry.segment_sum import Four, distance_to_sum, time_to_sum
from benchnav.kernels import kernel_without_allocation


@kernel_without_allocation
def set_axes(world: Any, agents: AnyArray) -> None:
    """Write the axis of every agent: the unit vector of its heading."""
    for i in range(world.agents):
        if agents[i].shaped:
            agents[i].axis_x, agents[i].axis_y = cos_sin(agents[i].heading)


@kernel_without_allocation
def sum_with_segment(a: Any, hx: float, hy: float) -> tuple[Four, Four]:
    """Return the half segments of agent a's core and of a segment ±(hx, hy)."""
    x, y = a.core_length * a.axis_x, a.core_length * a.axis_y
    u, v = -a.core_width * a.axis_y, a.core_width * a.axis_x
    return (x, u, hx, 0.0), (y, v, hy, 0.0)


@kernel_without_allocation
def sum_with_agent(a: Any, b: Any) -> tuple[Four, Four]:
    """Return the half segments of both agents' cores."""
    gx = (
        a.core_length * a.axis_x, -a.core_width * a.axis_y,
        b.core_length * b.axis_x, -b.core_width * b.axis_y,
    )  # fmt: skip
    gy = (
        a.core_length * a.axis_y, a.core_width * a.axis_x,
        b.core_length * b.axis_y, b.core_width * b.axis_x,
    )  # fmt: skip
    return gx, gy


@kernel_without_allocation
def agents_time(fx: float, fy: float, wx: float, wy: float, left: float, a: Any, b: Any) -> float:
    """Return the time until agent a touches b, from its relative position and velocity.

    It is inf if they cannot touch within ``left`` [s].
    """
    way = (abs(wx) + abs(wy)) * left
    far = a.radius + b.radius + way
    if fx * fx + fy * fy > far * far:
        return math.inf
    gx, gy = sum_with_agent(a, b)
    return time_to_sum(fx, fy, wx, wy, a.rounding + b.rounding, way, gx, gy)


@kernel_without_allocation
def agent_capsule_time(
    px: float, py: float, wx: float, wy: float, way: float, a: Any, c: Any
) -> float:
    """Return the time until agent a, at p in the frame of capsule c, touches it within ``way``."""
    qx, qy = nearest_on_segment(px, py, c.x0, c.y0, c.x1, c.y1)
    far = a.radius + c.r + way
    if (px - qx) * (px - qx) + (py - qy) * (py - qy) > far * far:
        return math.inf
    gx, gy = sum_with_segment(a, 0.5 * (c.x1 - c.x0), 0.5 * (c.y1 - c.y0))
    fx, fy = px - 0.5 * (c.x0 + c.x1), py - 0.5 * (c.y0 + c.y1)
    return time_to_sum(fx, fy, wx, wy, a.rounding + c.r, way, gx, gy)


@kernel_without_allocation
def agents_gap(fx: float, fy: float, a: Any, b: Any) -> tuple[float, float, float]:
    """Return (nx, ny, gap): the direction from b to agent a, and the gap [m] of their surfaces."""
    gx, gy = sum_with_agent(a, b)
    nx, ny, distance = distance_to_sum(fx, fy, gx, gy)
    return nx, ny, distance - a.rounding - b.rounding


@kernel_without_allocation
def agent_capsule_gap(px: float, py: float, a: Any, c: Any) -> tuple[float, float, float]:
    """Return (nx, ny, gap) of agent a, at p in the frame of capsule c."""
    gx, gy = sum_with_segment(a, 0.5 * (c.x1 - c.x0), 0.5 * (c.y1 - c.y0))
    fx, fy = px - 0.5 * (c.x0 + c.x1), py - 0.5 * (c.y0 + c.y1)
    nx, ny, distance = distance_to_sum(fx, fy, gx, gy)
    return nx, ny, distance - a.rounding - c.r


@kernel_without_allocation
def depth_within(a: Any, body: Any, shapes: AnyArray) -> float:
    """Return how far [m] agent a, whose centre is within a body, is from leaving it.

    It leaves through an edge: by the way from the centre to the edge, and the agent's extent in
    that direction.
    """
    least = math.inf
    px, py = a.x - body.x, a.y - body.y
    for q in range(body.first, body.last):
        c = shapes[q]
        qx, qy = nearest_on_segment(px, py, c.x0, c.y0, c.x1, c.y1)
        dx, dy = px - qx, py - qy
        d = math.sqrt(dx * dx + dy * dy)
        extent = a.core_length
        if d > 0.0:
            extent = a.core_length * abs(dx * a.axis_x + dy * a.axis_y) / d
            extent += a.core_width * abs(dy * a.axis_x - dx * a.axis_y) / d
        least = min(least, d + extent + c.r)
    return least + float(a.rounding)
