"""Random points of regions, and the search for a place by rejection."""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

from benchnav.arrays import BoolArray, Extent, FloatArray
from benchnav.kernels import kernel_without_allocation
from benchnav.scenario.sampling.region import Anywhere, Points, Rectangle, Region, Ring

MANY = (8, 24, 96, 384)  # candidates that are tested together, until one will do
FEW = (8, 24)


Part = Literal["start", "goal"]
Fault = Literal["no place", "blocked", "unreachable"]


class NoPlaceError(Exception):
    """A draw has no place for an object; the message names it. Never leaves `build`."""

    part: Part = "start"  # of a team
    fault: Fault = "no place"
    team: int | None = None  # index of the team whose part had no place


def draw_points(region: Region, bounds: Extent, count: int, rng: np.random.Generator) -> FloatArray:
    """Return points (count, 2) of ``region`` [m], uniform by area."""
    if isinstance(region, Points):
        return np.array(region.points)[rng.integers(len(region.points), size=count)]
    if isinstance(region, Rectangle | Anywhere):
        low, size = _box(region.box(bounds))
        return low + rng.random((count, 2)) * size
    inner, outer = (region.inner, region.outer) if isinstance(region, Ring) else (0, region.radius)
    return np.array(region.center) + _in_ring(inner, outer, count, rng)


@lru_cache(maxsize=64)
def _box(extent: Extent) -> tuple[FloatArray, FloatArray]:
    """Return the lower left corner (2,) and the size (2,) [m] of a rectangle."""
    x0, y0, x1, y1 = extent
    return np.array([x0, y0]), np.array([x1 - x0, y1 - y0])


def within(bounds: Extent, points: FloatArray) -> BoolArray:
    """Whether each of the points (N, 2) lies within ``bounds``, edges included, (N,)."""
    x0, y0, x1, y1 = bounds
    found: BoolArray = np.all((points >= (x0, y0)) & (points <= (x1, y1)), axis=1)
    return found


def directions(count: int, rng: np.random.Generator) -> FloatArray:
    """Return unit vectors (count, 2), by rejection from a square.

    Without sine and cosine they have the same bits everywhere.
    """
    out = np.empty((0, 2))
    while len(out) < count:
        ways = 2.0 * rng.random((2 * count + 8, 2)) - 1.0
        squared = np.sum(ways * ways, axis=1)
        good = (squared <= 1.0) & (squared > 1e-12)
        out = np.vstack([out, ways[good] / np.sqrt(squared[good])[:, None]])
    return out[:count]


def _in_ring(inner: float, outer: float, count: int, rng: np.random.Generator) -> FloatArray:
    out = directions(count, rng)
    share = rng.random(count)
    radius = np.sqrt(inner * inner + share * (outer * outer - inner * inner))
    return out * radius[:, None]


def find_place(
    propose: Callable[[int], FloatArray],
    first: Callable[[FloatArray], int],
    subject: str,
    batches: Sequence[int] = MANY,
) -> FloatArray:
    """Return the first proposed point (2,) [m] that is accepted.

    Args:
        propose: count → (count, 2) candidates.
        first: (N, 2) candidates → the index of the first acceptable one; -1 if there is none.
        subject: the object to place, for the error message.
        batches: numbers of candidates tested together, until one is accepted.

    Raises:
        NoPlaceError: no candidate is acceptable.
    """
    for size in batches:
        candidates = propose(size)
        k = first(candidates)
        if k >= 0:
            place: FloatArray = candidates[k]
            return place
    raise NoPlaceError(f"no free place for {subject} in {sum(batches)} tries")


@kernel_without_allocation
def next_apart(
    begin: int, points: FloatArray, origin: FloatArray, least: float, others: FloatArray,
    radius: FloatArray, gap: float,
) -> int:  # fmt: skip
    """Return the index ≥ ``begin`` of the next of the points (N, 2) that keeps all distances.

    It is ``least`` [m] or more from ``origin`` (2,), and farther than ``radius`` (M,) + ``gap``
    [m] from each of the ``others`` (M, 2). The result is -1 if there is none.
    """
    for n in range(begin, len(points)):
        x, y = points[n, 0], points[n, 1]
        dx, dy = x - origin[0], y - origin[1]
        apart = math.sqrt(dx * dx + dy * dy) >= least
        for m in range(len(others)):
            if not apart:
                break
            dx, dy = x - others[m, 0], y - others[m, 1]
            apart = math.sqrt(dx * dx + dy * dy) > radius[m] + gap
        if apart:
            return n
    return -1


def length(vector: FloatArray) -> float:
    """Return the length of a vector (2,)."""
    return math.sqrt(float(vector[0] * vector[0] + vector[1] * vector[1]))
