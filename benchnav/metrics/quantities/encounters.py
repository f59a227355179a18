"""Smallest distances and times to collision of agents and obstacles: kernels.

All motion between states is straight, so the smallest distance within a step is the distance
of two segments, not of two samples. A partner that is far away has no influence in the next
steps, because no agent is faster than its largest speed: these steps are skipped without a
change of any result. Time to collision falls within a step, so its smallest value in the step
is the one at its end.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import capsule_time, disc_time, nearest_on_segment
from benchnav.geometry.sweep import segment_distance2
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.metrics.quantities.footprint_gaps import lower_gaps
from benchnav.metrics.quantities.trajectory import Trajectories
from benchnav.world.bodies import is_away

TTC_CAP = 5.0  # [s] later collisions do not count
RECORDED = 2.4  # [m] gaps between agents are recorded up to this
NEAR = 4.0  # radii between centres: two diameters
SLACK = 1e-9  # [m] tolerance for rounding when steps are skipped
GROUP = 8  # capsules that are tested together
FARTHEST = 1e6  # [m] the gap to a body that is absent
LONG = 4.0  # [m] longer capsules are tested alone


class Things(NamedTuple):
    """Solids and bodies as capsules; bodies are centred at the origin and moved by an offset."""

    capsules: FloatArray  # (P, 5)
    body: IntArray  # (P,) index of its offset, -1: none
    offset: FloatArray  # (M, T+1, 2) [m]
    jumps: BoolArray  # (M,) it is re-placed instantly and does not travel


class Encounters(NamedTuple):
    """The result, for the duration of each agent's attempt."""

    clearance: (
        FloatArray  # (A,) [m] smallest gap to anything; negative in overlap, inf: nothing there
    )
    time_to_collision: FloatArray  # (A,) [s] smallest, at constant velocities, at most TTC_CAP
    gap: FloatArray  # (A, T+1) [m] to the nearest agent, at most RECORDED
    near: BoolArray  # (A, T+1) another agent's centre is within NEAR radii


def things_of(world: World, body_position: FloatArray) -> Things:
    """Return the obstacles of a world with bodies at ``body_position`` (T+1, M, 2)."""
    parts = [(solid.capsules, -1) for solid in world.solids]
    parts += [(body.solid.capsules, m) for m, body in enumerate(world.bodies)]
    capsules = np.vstack([np.zeros((0, 5)), *(part for part, _ in parts)])
    owner = np.repeat([m for _, m in parts], [len(part) for part, _ in parts]).astype(np.int64)
    jumps = [b.solid.kind == Kind.STATIC or b.law.kind == LawKind.RELOCATE for b in world.bodies]
    offset = np.ascontiguousarray(body_position.transpose(1, 0, 2), dtype=np.float64)
    return Things(capsules, owner, offset, np.array(jumps, np.bool_))


def encounters(
    trajectories: Trajectories, radius: FloatArray, things: Things,
    shapes: tuple[FloatArray, FloatArray] | None = None,
) -> Encounters:  # fmt: skip
    """Return clearance, time to collision and nearest agents of agents with ``radius`` (A,) [m].

    ``shapes`` are those of `shapes_of` with the headings (A, T+1) [rad], in worlds with bodies
    that are not discs. Clearance and gaps are then those of the shapes; the other results are
    those of the circles around them.
    """
    t = trajectories
    shape = t.position.shape[:2]
    found = Encounters(
        np.full(len(t), math.inf), np.full(len(t), TTC_CAP), np.full(shape, RECORDED),
        np.zeros(shape, np.bool_),
    )  # fmt: skip
    top = t.speed.max(axis=1, initial=0.0)
    enters = np.zeros(len(t), np.int64) if t.enters is None else t.enters
    meet_things(
        t.position, t.velocity, t.duration, t.last, enters, radius, top, t.dt, *things, *found[:2]
    )
    meet_agents(
        t.position, t.velocity, t.duration, t.last, enters, t.leaves, radius, top, t.dt, *found
    )
    if shapes is not None:
        found.clearance[:], found.gap[:] = math.inf, RECORDED
        lower_gaps(
            t.position, t.velocity, t.duration, t.last, enters, t.leaves, shapes[1], shapes[0],
            radius, t.dt, *things, found.clearance, found.gap,
        )  # fmt: skip
    return found


@kernel_without_allocation
def _skip(gap: float, clearance: float, ttc: float, top: float, dt: float) -> float:
    """Return the steps until a partner can have influence, at closing speeds up to ``top``."""
    if top <= 0.0:
        return math.inf
    gap -= SLACK
    return min((gap - clearance) / (top * dt), (gap / top - ttc) / dt)


@kernel
def meet_things(
    position: FloatArray, velocity: FloatArray, duration: FloatArray, last: IntArray,
    enters: IntArray, radius: FloatArray, top: FloatArray, dt: float, capsules: FloatArray,
    body: IntArray, offset: FloatArray, jumps: BoolArray, clearance: FloatArray, ttc: FloatArray,
) -> None:  # fmt: skip
    """Lower ``clearance`` and ``ttc`` (A,) to their values for solids and bodies.

    Few consecutive capsules of one solid or body are first tested together, by their circle.
    """
    first, circle = _circles(capsules, body)
    body_top = np.zeros(len(offset))
    _meet_groups(
        position, velocity, duration, last, enters, radius, top, dt, capsules, body, offset, jumps,
        first, circle, body_top, clearance, ttc,
    )  # fmt: skip


@kernel
def _circles(capsules: FloatArray, body: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the first capsules (G + 1,) of groups, and circles (G, 3) x, y, radius around them.

    The capsules of a group touch end to end, and belong to one body or to none.
    """
    count = len(capsules)
    first, circle = np.zeros(count + 1, np.int64), np.empty((count, 3))
    groups, c = 0, 0
    while c < count:
        end = c + 1
        while (
            end < min(count, c + GROUP) and body[end] == body[c]
            and _is_short(capsules, c) and _is_short(capsules, end)
            and capsules[end, 0] == capsules[end - 1, 2]
            and capsules[end, 1] == capsules[end - 1, 3]
        ):  # fmt: skip
            end += 1
        _write_circle(capsules, c, end, circle[groups])
        groups += 1
        first[groups] = end
        c = end
    return first[: groups + 1], circle[:groups]


@kernel_without_allocation
def _write_circle(capsules: FloatArray, first: int, end: int, circle: FloatArray) -> None:
    """Write a circle (3,) around some capsules."""
    x0, y0, x1, y1, most = math.inf, math.inf, -math.inf, -math.inf, 0.0
    for c in range(first, end):
        ax, ay, bx, by = capsules[c, 0], capsules[c, 1], capsules[c, 2], capsules[c, 3]
        x0, y0 = min(x0, ax, bx), min(y0, ay, by)
        x1, y1, most = max(x1, ax, bx), max(y1, ay, by), max(most, capsules[c, 4])
    wide, tall = x1 - x0, y1 - y0
    circle[0], circle[1] = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
    circle[2] = 0.5 * math.sqrt(wide * wide + tall * tall) + most


@kernel_without_allocation
def _is_short(capsules: FloatArray, c: int) -> bool:
    dx, dy = capsules[c, 2] - capsules[c, 0], capsules[c, 3] - capsules[c, 1]
    short: bool = dx * dx + dy * dy <= LONG * LONG
    return short


@kernel_without_allocation
def _meet_groups(
    position: FloatArray, velocity: FloatArray, duration: FloatArray, last: IntArray,
    enters: IntArray, radius: FloatArray, top: FloatArray, dt: float, capsules: FloatArray,
    body: IntArray, offset: FloatArray, jumps: BoolArray, first: IntArray, circle: FloatArray,
    body_top: FloatArray, clearance: FloatArray, ttc: FloatArray,
) -> None:  # fmt: skip
    _find_body_top(offset, jumps, dt, body_top)
    for a in range(position.shape[0]):
        for g in range(len(circle)):
            m = body[first[g]]
            fastest = top[a] + (body_top[m] if m >= 0 else 0.0)
            k = enters[a]
            while k < max(last[a], min(enters[a] + 1, position.shape[1])):
                dx, dy = position[a, k, 0] - circle[g, 0], position[a, k, 1] - circle[g, 1]
                if m >= 0:
                    dx, dy = dx - offset[m, k, 0], dy - offset[m, k, 1]
                gap = math.sqrt(dx * dx + dy * dy) - circle[g, 2] - radius[a]
                ahead = 0.0
                if gap >= clearance[a] and fastest < math.inf:
                    ahead = _skip(gap, clearance[a], ttc[a], fastest, dt)
                if ahead >= 1.0:
                    k = last[a] + 1 if ahead > last[a] else k + int(ahead)
                    continue
                least = math.inf
                for c in range(first[g], first[g + 1]):
                    gap = _thing_step(
                        a, c, k, position, velocity, duration, radius[a], dt, capsules, m, offset,
                        jumps, last[a] > enters[a], clearance, ttc,
                    )  # fmt: skip
                    least = min(least, gap)
                if least >= FARTHEST:  # it is absent
                    k += 1
                    continue
                ahead = _skip(least, clearance[a], ttc[a], fastest, dt)
                k = last[a] + 1 if ahead > last[a] else k + max(1, int(ahead))


@kernel_without_allocation
def _find_body_top(offset: FloatArray, jumps: BoolArray, dt: float, top: FloatArray) -> None:
    """Write the largest speeds (M,) [m/s]; inf for bodies that jump, appear or vanish."""
    for m in range(len(offset)):
        for k in range(offset.shape[1] - 1):
            if _comes_or_goes(offset, m, k, k + 1):
                top[m] = math.inf
            dx = offset[m, k + 1, 0] - offset[m, k, 0]
            dy = offset[m, k + 1, 1] - offset[m, k, 1]
            top[m] = max(top[m], math.sqrt(dx * dx + dy * dy) / dt)
        if jumps[m] and top[m] > 0.0:
            top[m] = math.inf


@kernel_without_allocation
def _comes_or_goes(offset: FloatArray, m: int, k: int, after: int) -> bool:
    """Whether body m appears or vanishes between the states k and ``after``."""
    here = is_away(offset[m, k, 0], offset[m, k, 1])
    there = is_away(offset[m, after, 0], offset[m, after, 1])
    return bool(here != there)


@kernel_without_allocation
def _thing_step(
    a: int, c: int, k: int, position: FloatArray, velocity: FloatArray, duration: FloatArray,
    radius: float, dt: float, capsules: FloatArray, m: int, offset: FloatArray, jumps: BoolArray,
    moves: bool, clearance: FloatArray, ttc: FloatArray,
) -> float:  # fmt: skip
    """Handle one step of an agent and a capsule, and return the gap [m] at its start.

    In the capsule's frame the agent's centre goes from p to q with velocity w. An
    obstacle is re-placed at the beginning of a step: the next state holds its new position.
    One that appears within a step counts from its end on; one that vanishes stands until then.
    """
    if m >= 0 and is_away(offset[m, k, 0], offset[m, k, 1]):
        return FARTHEST
    px, py = position[a, k, 0], position[a, k, 1]
    x0, y0, x1, y1 = capsules[c, 0], capsules[c, 1], capsules[c, 2], capsules[c, 3]
    reach = radius + capsules[c, 4]
    qx, qy, wx, wy = px, py, 0.0, 0.0
    if moves:
        qx, qy = position[a, k + 1, 0], position[a, k + 1, 1]
        wx, wy = velocity[a, k, 0], velocity[a, k, 1]
    if m >= 0:
        after = k + 1 if moves else k
        ox, oy = offset[m, after, 0], offset[m, after, 1]
        if not jumps[m]:
            ux, uy = (ox - offset[m, k, 0]) / dt, (oy - offset[m, k, 1]) / dt
            if _comes_or_goes(offset, m, k, after):
                ux, uy = 0.0, 0.0
            ox, oy = offset[m, k, 0], offset[m, k, 1]
            wx, wy = wx - ux, wy - uy
            if moves:
                qx, qy = qx - ux * duration[a, k], qy - uy * duration[a, k]
        px, py = px - ox, py - oy
        qx, qy = qx - ox, qy - oy
    nx, ny = nearest_on_segment(px, py, x0, y0, x1, y1)
    fx, fy = px - nx, py - ny
    apart = math.sqrt(fx * fx + fy * fy)
    gap: float = apart - reach
    travel = math.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
    if gap - travel < clearance[a]:
        least = math.sqrt(segment_distance2(px, py, qx, qy, x0, y0, x1, y1)) - reach
        clearance[a] = min(clearance[a], least)
    if moves and _may_touch(gap, apart, -(fx * wx + fy * wy), ttc[a] + dt):
        time = capsule_time(px, py, wx, wy, reach, math.inf, x0, y0, x1, y1)
        ttc[a] = min(ttc[a], max(0.0, time - duration[a, k]))
    return gap


@kernel_without_allocation
def _may_touch(gap: float, apart: float, closing: float, time: float) -> bool:
    """Whether a partner across ``gap`` [m] may touch within ``time`` [s].

    ``closing`` is the closing speed times the distance ``apart``. The gap to a convex partner is
    convex in time, so it never falls faster than at first.
    """
    soon: bool = gap * apart <= time * closing * (1.0 + SLACK) + SLACK
    return soon


@kernel_without_allocation
def meet_agents(
    position: FloatArray, velocity: FloatArray, duration: FloatArray, last: IntArray,
    enters: IntArray, leaves: IntArray, radius: FloatArray, top: FloatArray, dt: float,
    clearance: FloatArray, ttc: FloatArray, gap: FloatArray, near: BoolArray,
) -> None:  # fmt: skip
    """Lower ``clearance``, ``ttc`` (A,) and ``gap``, fill ``near`` (A, T+1), pair by pair."""
    states = position.shape[1]
    for i in range(position.shape[0]):
        for j in range(i + 1, position.shape[0]):
            fastest = top[i] + top[j]
            margin = max(RECORDED, (NEAR - 1.0) * max(radius[i], radius[j]))
            end = min(max(last[i], last[j]), min(leaves[i], leaves[j]))
            k = max(enters[i], enters[j])
            while k <= end:
                dx = position[j, k, 0] - position[i, k, 0]
                dy = position[j, k, 1] - position[i, k, 1]
                apart = math.sqrt(dx * dx + dy * dy)
                between = apart - (radius[i] + radius[j])
                _pair_sample(i, j, k, apart, between, last, enters, radius, clearance, gap, near)
                worst, latest = max(clearance[i], clearance[j]), max(ttc[i], ttc[j])
                if k < end:
                    wx = velocity[j, k, 0] - velocity[i, k, 0]
                    wy = velocity[j, k, 1] - velocity[i, k, 1]
                    near_miss = between - fastest * dt <= worst + SLACK
                    if near_miss or _may_touch(between, apart, -(dx * wx + dy * wy), latest + dt):
                        _pair_step(
                            i, j, k, position, velocity, duration, last, leaves, radius,
                            clearance, ttc,
                        )  # fmt: skip
                ahead = 0.0
                if between > margin:
                    worst, latest = max(clearance[i], clearance[j]), max(ttc[i], ttc[j])
                    ahead = _skip(between, worst, latest, fastest, dt)
                    if fastest > 0.0:
                        ahead = min(ahead, (between - margin) / (fastest * dt))
                k = end + 1 if ahead > states else k + max(1, int(ahead))


@kernel_without_allocation
def _pair_sample(
    i: int, j: int, k: int, apart: float, between: float, last: IntArray, enters: IntArray,
    radius: FloatArray, clearance: FloatArray, gap: FloatArray, near: BoolArray,
) -> None:  # fmt: skip
    """Handle one pair of agents in one state, with centres ``apart`` [m]."""
    for a in (i, j):
        if k <= last[a]:
            near[a, k] |= apart <= NEAR * radius[a]
            gap[a, k] = min(gap[a, k], between)
        if k < last[a] or k == enters[a]:
            clearance[a] = min(clearance[a], between)


@kernel_without_allocation
def _pair_step(
    i: int, j: int, k: int, position: FloatArray, velocity: FloatArray, duration: FloatArray,
    last: IntArray, leaves: IntArray, radius: FloatArray, clearance: FloatArray, ttc: FloatArray,
) -> None:  # fmt: skip
    """Handle one pair within one step: straight motion before and after the first one stops."""
    px = position[j, k, 0] - position[i, k, 0]
    py = position[j, k, 1] - position[i, k, 1]
    wx = velocity[j, k, 0] - velocity[i, k, 0]
    wy = velocity[j, k, 1] - velocity[i, k, 1]
    reach = radius[i] + radius[j]
    i_for = duration[i, k] if k < last[i] else duration[j, k]
    j_for = duration[j, k] if k < last[j] else duration[i, k]
    until = min(i_for, j_for)
    mx, my = px + wx * until, py + wy * until
    nx, ny = nearest_on_segment(0.0, 0.0, px, py, mx, my)
    least = math.sqrt(nx * nx + ny * ny) - reach
    time = disc_time(px, py, wx, wy, reach)
    for a in (i, j):
        if k < last[a]:
            clearance[a] = min(clearance[a], least)
            ttc[a] = min(ttc[a], max(0.0, time - until))
    if i_for == j_for:
        return
    stays, goes = (i, j) if i_for < j_for else (j, i)
    if leaves[stays] > last[stays]:
        qx = position[j, k + 1, 0] - position[i, k + 1, 0]
        qy = position[j, k + 1, 1] - position[i, k + 1, 1]
        nx, ny = nearest_on_segment(0.0, 0.0, mx, my, qx, qy)
        clearance[goes] = min(clearance[goes], math.sqrt(nx * nx + ny * ny) - reach)
