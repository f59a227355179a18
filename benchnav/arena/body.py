"""Bodies: obstacles that move, or that are moved during the episode, and never yield.

A dynamic obstacle follows a motion law; a static obstacle may be relocated once
within the episode. Bodies translate and do not turn.

A body that is absent is at `AWAY`, far outside every arena: no sensor reaches it and nothing
touches it. It appears and vanishes between two substeps, without travelling.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from benchnav.arena.solid import Solid
from benchnav.arrays import BoolArray, FloatArray

AWAY = (1e7, 1e7)  # [m] the position of an absent body
BEYOND = 1e6  # [m] a coordinate farther from the origin than this is that of an absent body


class LawKind(IntEnum):
    """How a body's position depends on time."""

    TRACK = 0  # piecewise linear in time: back-and-forth, waypoint loop, recorded track
    CIRCLE = 1  # constant angular speed around a centre
    RELOCATE = 2  # at rest; moves to a second place at a given time, or once that place is free


@dataclass(frozen=True, eq=False)
class Law:
    """A motion law with drawn numbers.

    The position at time t [s] is a pure function of t, except for RELOCATE, which waits until
    its new place is free.
    """

    kind: LawKind
    times: FloatArray  # (W,) [s], rising from 0. CIRCLE: [angular speed rad/s]. RELOCATE: [0, time]
    points: FloatArray  # (W, 2) [m]. CIRCLE: [centre, (radius, phase angle)]. RELOCATE: [old, new]
    periodic: bool = False  # TRACK: repeats after its last time (else it stays at its last point)
    phase: float = 0.0  # TRACK: seconds added to the clock


@dataclass(frozen=True, eq=False)
class Body:
    """A solid centred at the origin, and its motion law."""

    solid: Solid
    law: Law
    person: bool = False  # whether it is a person of the scenario's recording

    def left_out(self) -> frozenset[str]:
        """Return the names of the fields that are not hashed or stored: added, and at default."""
        return frozenset() if self.person else frozenset({"person"})


def absent(position: FloatArray) -> BoolArray:
    """Return which positions (…, 2) [m] are those of absent bodies."""
    beyond: BoolArray = np.asarray((np.abs(position) > BEYOND).any(axis=-1))
    return beyond


def still(position: FloatArray) -> Law:
    """Return a law that stays at ``position`` (2,) [m]."""
    return Law(LawKind.TRACK, np.zeros(1), np.asarray(position, float).reshape(1, 2))
