"""Inputs of kernels that steer agent by agent: rows N are (world, agent) pairs."""

from collections.abc import Iterable, Iterator

import numpy as np

from benchnav.arrays import AnyArray, FloatArray
from benchnav.navigation import Briefing, Observation

from ..controllers.orca.avoidance import no_edges, no_neighbours

BODY = 6  # radius [m], top and preferred speed [m/s], turn rate [rad/s], step [s], tolerance [m]


def bodies_of(briefing: Briefing) -> FloatArray:
    """Return the bodies (A, 6), see `BODY`."""
    body = np.empty((len(briefing), BODY))
    body[:, 0] = briefing.radius
    body[:, 1] = briefing.max_speed
    body[:, 2] = briefing.preferred_speed
    body[:, 3] = briefing.max_turn_rate
    body[:, 4] = briefing.dt
    body[:, 5] = briefing.goal_tolerance
    return body


def flat(rows: int, arrays: Iterable[AnyArray]) -> Iterator[AnyArray]:
    """Yield each array (B, A, …) as contiguous (rows, …)."""
    for array in arrays:
        yield np.ascontiguousarray(array).reshape(rows, *array.shape[2:])


def sensed(observation: Observation) -> tuple[AnyArray, ...]:
    """Return the readings of neighbours and edges as kernel arguments.

    Neighbours: position, velocity, radius, kind, count; edges: start, end, before, after, count.
    Each is (B, A, …); a missing sensor has no entries.
    """
    shape = observation.active.shape
    near = observation.neighbours or no_neighbours(*shape)
    sides = observation.edges or no_edges(*shape)
    return (
        near.position, near.velocity, near.radius, near.kind, near.count,
        sides.start, sides.end, sides.before, sides.after, sides.count,
    )  # fmt: skip
