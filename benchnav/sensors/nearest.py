"""The nearest spots and bodies around an agent: candidates from cells, and their order.

Spots are `benchnav.world.records.SPOT`. A place is the index of a spot, or -1 - m for body m.
"""

import math
from typing import Any

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import bucket
from benchnav.kernels import inlined, kernel_without_allocation
from benchnav.world.touch import WIDER

LANES = 16  # agents whose candidates are sorted together
SLOTS = 64  # candidates that are numbered by the last bits of a distance
CHAIN = 11  # length of a chain that sorts: neighbours, and one more to compare with the last one
CELL_I, CELL_J, SPAN, COUNT = range(4)  # of a window: its middle cell, cells around it, its spots
_DYNAMIC = int(Kind.DYNAMIC)


@inlined
def gather(
    own: int, room: int, far: float, limit: float, side: float, few: bool, everyone: bool,
    seen: BoolArray, a: Any, body_count: int, bodies: AnyArray, hashed: IntArray, spots: AnyArray,
    window: IntArray, x: FloatArray, y: FloatArray, at: IntArray, best: FloatArray,
    place: IntArray,
) -> int:  # fmt: skip
    """List the places around agent a at spot ``own``, and their squared distances in ``best``.

    Those within ``far`` [m] are listed; if they are fewer than ``room``, the search is repeated
    within a larger radius, up to ``limit`` [m]. Return their number.

    ``window``, ``x``, ``y`` and ``at`` describe the spots in the cells around a. The next agent in
    the same cell needs the same ones. ``few``: they are all spots, and there are no cells.
    """
    while True:
        if not few:
            spot, span = spots[own], math.ceil(WIDER * far / side)
            if spot.ci != window[CELL_I] or spot.cj != window[CELL_J] or span != window[SPAN]:
                window[CELL_I], window[CELL_J], window[SPAN] = spot.ci, spot.cj, span
                _look_around(hashed, spots, window, x, y, at)
        n = _gather_bodies(a, far * far, body_count, bodies, best, place)
        n = _gather_spots(own, a.x, a.y, far * far, window[COUNT], x, y, at, n, best, place)
        if not everyone:
            n = _keep_seen(n, seen[a.team], spots, best, place)
        if n >= room or far >= limit:
            break
        far = min(max(1.5 * far, side), limit)
    return n


@kernel_without_allocation
def look_at_all(
    hashed: IntArray, spots: AnyArray, window: IntArray, x: FloatArray, y: FloatArray, at: IntArray
) -> None:
    """Copy the positions of all spots."""
    for n in range(hashed[-1]):
        x[n], y[n], at[n] = spots[n].x, spots[n].y, n
    window[COUNT], window[SPAN] = hashed[-1], -1


@inlined
def _look_around(
    hashed: IntArray, spots: AnyArray, window: IntArray, x: FloatArray, y: FloatArray, at: IntArray
) -> None:
    """Copy the positions of the spots in the cells of a window.

    A row of cells is contiguous in the table, but for other rows that share its buckets.
    """
    n, size = 0, len(hashed) - 1
    ci, cj, span = window[CELL_I], window[CELL_J], window[SPAN]
    for row in range(cj - span, cj + span + 1):
        low = bucket(ci - span, row, size)
        high = low + min(2 * span + 1, size)
        for part in range(2 if high > size else 1):  # the row may continue at the table's start
            begin, end = (low, min(high, size)) if part == 0 else (0, high - size)
            for k in range(hashed[begin], hashed[end]):
                x[n], y[n], at[n] = spots[k].x, spots[k].y, k
                n += spots[k].cj == row
    window[COUNT] = n


@inlined
def _gather_bodies(
    a: Any, far: float, count: int, bodies: AnyArray, best: FloatArray, place: IntArray
) -> int:
    """List the dynamic obstacles within the root of ``far`` [m²]; return their number."""
    n = 0
    for m in range(count):
        body = bodies[m]
        d2 = (body.x - a.x) * (body.x - a.x) + (body.y - a.y) * (body.y - a.y)
        if body.kind == _DYNAMIC and d2 <= far:
            best[n], place[n] = d2, -1 - m
            n += 1
    return n


@inlined
def _gather_spots(
    own: int, own_x: float, own_y: float, far: float, count: int, x: FloatArray, y: FloatArray,
    at: IntArray, n: int, best: FloatArray, place: IntArray,
) -> int:  # fmt: skip
    """Add the others of ``count`` spots that are within the root of ``far`` [m²].

    Every candidate is written, and the next one overwrites it if it does not count: a branch that
    cannot be predicted costs more.
    """
    for k in range(count):
        d2 = (x[k] - own_x) * (x[k] - own_x) + (y[k] - own_y) * (y[k] - own_y)
        best[n], place[n] = d2, at[k]
        n += (d2 <= far) & (at[k] != own)
    return n


@kernel_without_allocation
def _keep_seen(n: int, seen: BoolArray, spots: AnyArray, best: FloatArray, place: IntArray) -> int:
    """Drop agents of ignored teams from n candidates; return the number of the others."""
    kept = 0
    for k in range(n):
        best[kept], place[kept] = best[k], place[k]
        kept += place[k] < 0 or seen[spots[place[k]].team]
    return kept


@kernel_without_allocation
def put_into_lane(n: int, lane: int, exact: IntArray, bits: IntArray) -> None:
    """Write n distances into a lane of `sort_lanes`; ``exact`` and ``bits`` are as integers.

    The last bits of each distance are replaced by the number of its candidate.
    """
    for k in range(n):
        bits[k * LANES + lane] = exact[k] & -SLOTS | k


@kernel_without_allocation
def sort_lanes(n: int, given: FloatArray, smallest: FloatArray) -> None:
    """Write the smallest of n numbers of each lane, in order.

    ``given`` (n, LANES) and ``smallest`` (CHAIN, LANES) are flat. A number moves down a chain of
    minima and maxima, which has no branch that cannot be predicted, and the compiler turns the loop
    over lanes into vector code.
    """
    for q in range(CHAIN * LANES):
        smallest[q] = math.inf
    for k in range(n):
        for lane in range(LANES):
            x = given[k * LANES + lane]
            for q in range(CHAIN):
                y = smallest[q * LANES + lane]
                smallest[q * LANES + lane] = y if y < x else x
                x = x if y < x else y


@kernel_without_allocation
def take_from_lane(
    n: int, room: int, lane: int, bits: IntArray, place: IntArray, ranked: IntArray
) -> bool:
    """Write the places of the nearest of n candidates, up to ``room``, into ``ranked``.

    Return False if two distances look equal: the last bits do not order them.
    """
    distinct = True
    for k in range(min(n, room)):
        key, following = bits[k * LANES + lane], bits[(k + 1) * LANES + lane]
        distinct &= (key ^ following) & -SLOTS != 0
        ranked[k] = place[key & (SLOTS - 1)]
    return distinct


@kernel_without_allocation
def insert(
    n: int, room: int, total: int, spots: AnyArray, best: FloatArray, place: IntArray,
    ranked: IntArray,
) -> float:  # fmt: skip
    """Sort n candidates by insertion; return the squared distance [m²] of the last one.

    The places of the nearest ones, up to ``room``, are written into ``ranked``. Equal distances are
    ordered by index, agents before bodies: the order is total, so that the order of discovery does
    not matter.
    """
    kept = 0
    for k in range(n):
        d2, candidate, at = best[k], place[k], kept
        key = _order(candidate, total, spots)
        if kept == room:
            at -= 1
            if at < 0 or not _precedes(d2, key, best[at], ranked[at], total, spots):
                continue
        else:
            kept += 1
        while at > 0 and _precedes(d2, key, best[at - 1], ranked[at - 1], total, spots):
            best[at], ranked[at] = best[at - 1], ranked[at - 1]
            at -= 1
        best[at], ranked[at] = d2, candidate
    return float(best[kept - 1]) if kept > 0 else 0.0


@kernel_without_allocation
def _precedes(
    d2: float, key: int, other_d2: float, other: int, total: int, spots: AnyArray
) -> bool:
    return d2 < other_d2 or (d2 == other_d2 and key < _order(other, total, spots))


@kernel_without_allocation
def _order(place: int, total: int, spots: AnyArray) -> int:
    """Return the key of a candidate among those at equal distance."""
    return int(spots[place].index) if place >= 0 else total - 1 - place
