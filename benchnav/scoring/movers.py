"""The moving obstacles of a scenario beside recorded tracks: their positions and contacts."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.body import Body, absent
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel
from benchnav.scoring.touches import MAX_EVENTS, meet_solids
from benchnav.world.bodies import body_at, law_records


def mover_positions(bodies: Sequence[Body], states: int, dt: float) -> FloatArray:
    """Return where obstacles are at each multiple of ``dt`` [s], (T+1, M, 2) [m]."""
    position = np.empty((states, len(bodies), 2))
    if bodies:
        records, knots = law_records(bodies)
        write_positions(records, knots, dt, position)
    return position


@kernel
def write_positions(bodies: AnyArray, knots: AnyArray, dt: float, position: FloatArray) -> None:
    """Write the position (T+1, M, 2) [m] of each body at multiples of ``dt`` [s]."""
    for k in range(position.shape[0]):
        for m in range(position.shape[1]):
            position[k, m] = body_at(bodies[m], knots, k * dt)


def mover_contacts(
    place: FloatArray, first: IntArray, last: IntArray, dt: float, radius: FloatArray,
    bodies: Sequence[Body], position: FloatArray,
) -> FloatArray:  # fmt: skip
    """Return contacts (N, 6) with obstacles at ``position`` (T+1, M, 2); as `touches.meet_pairs`.

    The partner of obstacle m is -1 - m. Motion relative to an obstacle is straight in each step.
    """
    found, events = [np.zeros((0, 6))], np.empty((MAX_EVENTS, 6))
    for m, body in enumerate(bodies):
        capsules = body.solid.capsules
        owner = np.full(len(capsules), -1 - m)
        relative = np.ascontiguousarray(place - position[:, m])
        for begin, end in _intervals(~absent(position[:, m])):
            low, high = np.maximum(first, begin), np.minimum(last, end)
            count = meet_solids(relative, low, high, dt, radius, capsules, owner, events)
            found.append(events[:count].copy())
    return np.concatenate(found)


def _intervals(here: BoolArray) -> IntArray:
    """Return (first, last) of each interval of successive states (T+1,) that are true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]])))
    intervals: IntArray = edges.reshape(-1, 2) - np.array([0, 1])
    return intervals
