"""Contacts between recorded discs, and with walls: maximal intervals of time.

All motion between states is straight. A contact begins at an overlap and ends at a gap wider
than that by which the simulator ends one.
"""

import math

import numpy as np

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import FloatArray, IntArray
from benchnav.episode.episode import Contacts
from benchnav.errors import TrajectoryError
from benchnav.geometry.capsule import capsule_time, nearest_on_segment
from benchnav.geometry.sweep import segment_distance2
from benchnav.kernels import kernel, kernel_without_allocation

RELEASE = 0.01  # [m] a contact ends at a wider gap, as in `benchnav.world.contacts`
TOUCH = 1e-6  # [m] a smaller gap is a contact: files round positions
MAX_EVENTS = 1_000_000


def touches(
    place: FloatArray, first: IntArray, last: IntArray, dt: float, gone: FloatArray,
    radius: FloatArray, solids: tuple[Solid, ...], stop: FloatArray, movers: FloatArray,
) -> Contacts:  # fmt: skip
    """Return the contacts of agents at ``place`` (A, T+1, 2) [m] from state ``first`` to ``last``.

    An agent reaches its last place at the time ``gone`` (A,) [s]. Contacts that begin before
    ``stop`` (A,) [s] are charged. ``movers`` (N, 6) are those of `movers.mover_contacts`.

    Raises TrajectoryError for more than `MAX_EVENTS` contacts of a kind.
    """
    pairs = np.empty((MAX_EVENTS, 6))
    count = meet_pairs(place, first, last, dt, gone, radius, pairs)
    events = [
        (pairs[:count, [1, 0, 2, 3, 4, 5]], Kind.AGENT), (pairs[:count], Kind.AGENT),
        (movers, Kind.DYNAMIC),
    ]  # fmt: skip
    for kind in (Kind.WALL, Kind.STATIC):
        own = [n for n, solid in enumerate(solids) if solid.kind == kind]
        if own:
            capsules = np.vstack([solids[n].capsules for n in own])
            owner = np.repeat(own, [len(solids[n].capsules) for n in own])
            found = np.empty((MAX_EVENTS, 6))
            events.append(
                (found[: meet_solids(place, first, last, dt, radius, capsules, owner, found)], kind)
            )
    if max(len(part) for part, _ in events) >= MAX_EVENTS:
        raise TrajectoryError(
            f"There may be at most {MAX_EVENTS} contacts; there are more. Check radius and unit."
        )
    rows = np.concatenate([part for part, _ in events])
    kinds = np.repeat([int(kind) for _, kind in events], [len(part) for part, _ in events])
    order = np.lexsort((rows[:, 2], rows[:, 0]))
    rows, kinds = rows[order], kinds[order]
    agent = rows[:, 0].astype(np.int64)
    return Contacts(
        agent=agent, kind=kinds.astype(np.int8), partner=rows[:, 1].astype(np.int64),
        start=rows[:, 2], end=rows[:, 3], penetration=rows[:, 4], closing_speed=rows[:, 5],
        charged=np.asarray(rows[:, 2] < stop[agent]),
    )  # fmt: skip


@kernel_without_allocation
def _crossing(px: float, py: float, wx: float, wy: float, reach: float) -> tuple[float, float]:
    """Return the times from and until which p + w t is within ``reach``; inf, -inf if never."""
    a, b = wx * wx + wy * wy, px * wx + py * wy
    c = px * px + py * py - reach * reach
    if a <= 0.0:
        return (-math.inf, math.inf) if c <= 0.0 else (math.inf, -math.inf)
    root = b * b - a * c
    if root < 0.0:
        return math.inf, -math.inf
    root = math.sqrt(root)
    return (-b - root) / a, (-b + root) / a


@kernel
def meet_pairs(
    place: FloatArray, first: IntArray, last: IntArray, dt: float, gone: FloatArray,
    radius: FloatArray, events: FloatArray,
) -> int:  # fmt: skip
    """Write contacts of agents: agent, partner, start, end, penetration, closing speed.

    An agent reaches its last place at the time ``gone`` (A,) [s]. Returns the number of contacts;
    more than fit into ``events`` are dropped.
    """
    count, top = 0, _fastest(place, dt)
    for i in range(len(place)):
        for j in range(i + 1, len(place)):
            reach, k, end = radius[i] + radius[j], max(first[i], first[j]), min(last[i], last[j])
            opened, fastest = False, (top[i] + top[j]) * dt
            while k < end:
                px, py = place[j, k, 0] - place[i, k, 0], place[j, k, 1] - place[i, k, 1]
                gap = math.sqrt(px * px + py * py) - reach
                if not opened and gap > 2.0 * fastest + TOUCH:
                    k += int((gap - TOUCH) / fastest) if fastest > 0.0 else int(end - k)
                    continue
                i_for, j_for = min(dt, gone[i] - k * dt), min(dt, gone[j] - k * dt)
                until = min(i_for, j_for)
                if until <= 0.0:
                    break
                wx, wy = _velocity(place, j, k, j_for, i, i_for)
                now = _pair_step(px, py, wx, wy, until, reach, opened, events[count], k * dt)
                if now[0] and not opened:
                    events[count, 0], events[count, 1] = i, j
                opened = now[0] and not now[1]
                count += now[0] and now[1]
                if count >= len(events):
                    return count
                k += 1
            count += opened
            if count >= len(events):
                return count
    return count


@kernel_without_allocation
def _velocity(
    place: FloatArray, j: int, k: int, j_for: float, i: int, i_for: float
) -> tuple[float, float]:
    """Return the velocity [m/s] of j relative to i, which move for these times after state k."""
    x = (place[j, k + 1, 0] - place[j, k, 0]) / j_for
    y = (place[j, k + 1, 1] - place[j, k, 1]) / j_for
    x -= (place[i, k + 1, 0] - place[i, k, 0]) / i_for
    y -= (place[i, k + 1, 1] - place[i, k, 1]) / i_for
    return x, y


@kernel_without_allocation
def _pair_step(
    px: float, py: float, wx: float, wy: float, until: float, reach: float, opened: bool,
    event: FloatArray, time: float,
) -> tuple[bool, bool]:  # fmt: skip
    """Continue or begin a contact within one step; return whether there is one, and its end."""
    since = 0.0
    if not opened:
        enter, leave = _crossing(px, py, wx, wy, reach + TOUCH)
        since = max(enter, 0.0)
        if since > min(leave, until):
            return False, False
        dx, dy = px + wx * since, py + wy * since
        event[2], event[4] = time + since, 0.0
        event[5] = -(dx * wx + dy * wy) / max(math.sqrt(dx * dx + dy * dy), 1e-12)
    ax, ay, bx, by = px + wx * since, py + wy * since, px + wx * until, py + wy * until
    nx, ny = nearest_on_segment(0.0, 0.0, ax, ay, bx, by)
    event[4] = max(event[4], reach - math.sqrt(nx * nx + ny * ny))
    _, leave = _crossing(px, py, wx, wy, reach + RELEASE)
    event[3] = time + min(max(leave, 0.0), until)
    return True, leave < until


@kernel
def _fastest(place: FloatArray, dt: float) -> FloatArray:
    """Return the largest speed (A,) [m/s]."""
    top = np.zeros(len(place))
    for a in range(len(place)):
        for k in range(place.shape[1] - 1):
            dx, dy = place[a, k + 1, 0] - place[a, k, 0], place[a, k + 1, 1] - place[a, k, 1]
            top[a] = max(top[a], math.sqrt(dx * dx + dy * dy) / dt)
    return top


@kernel
def meet_solids(
    place: FloatArray, first: IntArray, last: IntArray, dt: float, radius: FloatArray,
    capsules: FloatArray, owner: IntArray, events: FloatArray,
) -> int:  # fmt: skip
    """Write contacts with solids, whose capsules (P, 5) are consecutive; as `meet_pairs`."""
    count, top, low = 0, _fastest(place, dt), 0
    while low < len(capsules):
        high = low
        while high < len(capsules) and owner[high] == owner[low]:
            high += 1
        for a in range(len(place)):
            k, opened = first[a], False
            while k < last[a]:
                gap, since, until, speed = _solid_step(
                    place[a, k], place[a, k + 1], dt, radius[a], capsules, low, high
                )
                if since <= dt and not opened and count < len(events):
                    opened = True
                    events[count, 0], events[count, 1], events[count, 4] = a, owner[low], 0.0
                    events[count, 2], events[count, 5] = k * dt + since, speed
                if opened:
                    events[count, 3] = k * dt + until
                    events[count, 4] = max(events[count, 4], -gap)
                    if until < dt:
                        opened = False
                        count += 1
                ahead = 1
                if not opened and top[a] > 0.0 and gap > 2.0 * top[a] * dt:
                    ahead = max(1, int((gap - TOUCH) / (top[a] * dt)))
                k += ahead
            if opened:
                count += 1
        low = high
    return count


@kernel_without_allocation
def _solid_step(
    p: FloatArray, q: FloatArray, dt: float, radius: float, capsules: FloatArray, low: int,
    high: int,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the smallest gap in a step, from and until when there is contact, closing speed."""
    least, since, until, speed = math.inf, math.inf, 0.0, 0.0
    wx, wy = (q[0] - p[0]) / dt, (q[1] - p[1]) / dt
    for c in range(low, high):
        x0, y0, x1, y1 = capsules[c, 0], capsules[c, 1], capsules[c, 2], capsules[c, 3]
        reach = radius + capsules[c, 4]
        gap = math.sqrt(segment_distance2(p[0], p[1], q[0], q[1], x0, y0, x1, y1)) - reach
        least = min(least, gap)
        if gap > RELEASE:
            continue
        if gap <= TOUCH:
            time = _reach_time(p[0], p[1], wx, wy, reach + TOUCH, x0, y0, x1, y1)
            if time < since:
                nx, ny = nearest_on_segment(p[0] + wx * time, p[1] + wy * time, x0, y0, x1, y1)
                dx, dy = nx - p[0] - wx * time, ny - p[1] - wy * time
                apart = max(math.sqrt(dx * dx + dy * dy), 1e-12)
                since, speed = time, (dx * wx + dy * wy) / apart
        back = _reach_time(q[0], q[1], -wx, -wy, reach + RELEASE, x0, y0, x1, y1)
        until = max(until, dt - back)
    return least, since, until, speed


@kernel_without_allocation
def _reach_time(
    px: float, py: float, wx: float, wy: float, reach: float,
    x0: float, y0: float, x1: float, y1: float,
) -> float:  # fmt: skip
    """Return the first t ≥ 0 with p + w t within ``reach`` of a segment that it does reach."""
    nx, ny = nearest_on_segment(px, py, x0, y0, x1, y1)
    if (px - nx) * (px - nx) + (py - ny) * (py - ny) <= reach * reach:
        return 0.0
    time = capsule_time(px, py, wx, wy, reach, math.inf, x0, y0, x1, y1)
    return 0.0 if time == math.inf else time
