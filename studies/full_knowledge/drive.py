"""One decision of one agent: where it leads, and whether it touches anything.

The same operations as the simulator's, in the same order, so that a plan is driven to the
same bits. Within a substep all move straight: seen from the other, an agent runs along a
segment, and the exact distance of that segment decides.
"""

import math

from benchnav.arrays import FloatArray
from benchnav.geometry.capsule import disc_time
from benchnav.geometry.capsule_grid import CapsuleGrid, is_clear
from benchnav.geometry.rotation import wrap
from benchnav.geometry.sweep import is_free_of, point_segment_distance2
from benchnav.kernels import kernel
from benchnav.world.dynamics import planar_velocity

from .scene import MARGIN, Movers, Task, Traffic

HIT, CLEAR, ARRIVED = -1, 0, 1


@kernel
def drive(
    task: Task, ground: CapsuleGrid, movers: Movers, traffic: Traffic,
    x: float, y: float, heading: float, step: int, v: float, w: float,
) -> tuple[int, float, float, float]:  # fmt: skip
    """(HIT, CLEAR or ARRIVED, x, y, heading) after the twist (v [m/s], w [rad/s])."""
    for s in range(task.substeps):
        tick = step * task.substeps + s
        vx, vy = planar_velocity(v, w, True, heading, task.h)
        share = min(goal_time(task, x, y, vx, vy) / task.h, 2.0)
        part = min(share, 1.0)  # of the substep, until it is over or the agent arrives
        dx, dy = part * vx * task.h, part * vy * task.h
        if v != 0.0 and not is_clear(ground, x, y, x + dx, y + dy):
            return HIT, x, y, heading
        if meets_mover(task, movers, tick, part, x, y, dx, dy):
            return HIT, x, y, heading
        if meets_agent(task, traffic, tick, part, x, y, dx, dy):
            return HIT, x, y, heading
        x, y = x + vx * task.h, y + vy * task.h
        heading = wrap(heading + w * task.h)
        if share <= 1.0:
            return ARRIVED, x, y, heading
    return CLEAR, x, y, heading


@kernel
def goal_time(task: Task, x: float, y: float, vx: float, vy: float) -> float:
    """Time [s] until the agent touches its goal disc, less MARGIN; 0 inside it, inf if never."""
    fx, fy, reach = x - task.goal_x, y - task.goal_y, task.tolerance - MARGIN
    if fx * fx + fy * fy <= reach * reach:
        return 0.0
    return disc_time(fx, fy, vx, vy, reach)


@kernel
def meets_mover(
    task: Task, movers: Movers, tick: int, part: float, x: float, y: float, dx: float, dy: float
) -> bool:
    """Does the agent, going (dx, dy) [m] in ``part`` of a substep, come too close to a mover?"""
    radius = task.radius + MARGIN
    for m in range(len(movers.bound)):
        here, there = movers.place[tick, m], movers.place[tick + 1, m]
        ax, ay = x - here[0], y - here[1]
        wx, wy = dx - part * (there[0] - here[0]), dy - part * (there[1] - here[1])
        far = radius + movers.bound[m] + abs(wx) + abs(wy)
        if ax * ax + ay * ay > far * far:
            continue
        for q in range(movers.first[m], movers.first[m + 1]):
            if not is_free_of(ax, ay, ax + wx, ay + wy, radius, movers.capsules[q]):
                return True
    return False


@kernel
def meets_agent(
    task: Task, traffic: Traffic, tick: int, part: float, x: float, y: float, dx: float, dy: float
) -> bool:
    """As `meets_mover`, for the agents that were planned before."""
    for n in range(len(traffic.ticks)):
        if tick >= traffic.ticks[n]:
            continue
        here, there = traffic.place[n, tick], traffic.place[n, tick + 1]
        ax, ay = x - here[0], y - here[1]
        bx, by = ax + dx - part * (there[0] - here[0]), ay + dy - part * (there[1] - here[1])
        reach = task.radius + traffic.radius[n] + MARGIN
        if point_segment_distance2(0.0, 0.0, ax, ay, bx, by) < reach * reach:
            return True
    return False


@kernel
def follow(task: Task, commands: FloatArray, path: FloatArray) -> None:
    """Writes path (K+1, 2) [m]: where ``commands`` (T, 2) lead, and stay, at every tick."""
    x, y, heading, k = task.x, task.y, task.heading, 0
    path[0, 0], path[0, 1] = x, y
    for step in range(len(commands)):
        for _ in range(task.substeps):
            v, w = commands[step, 0], commands[step, 1]
            vx, vy = planar_velocity(v, w, True, heading, task.h)
            x, y, heading = x + vx * task.h, y + vy * task.h, wrap(heading + w * task.h)
            k += 1
            path[k, 0], path[k, 1] = x, y
    for rest in range(k + 1, len(path)):
        path[rest, 0], path[rest, 1] = x, y


@kernel
def distance(ax: float, ay: float, bx: float, by: float) -> float:
    """[m]"""
    return math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by))
