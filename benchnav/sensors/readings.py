"""Sensor readings: rays, neighbours and edges of some agents in a batch of worlds.

Arrays start with (B, A): the worlds and the requested agents of a call.
World frame.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Self

import numpy as np

from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray

FORM = ("heading", "half_length", "half_width", "rounding")  # of `Neighbours`
_ZERO: Any = None


class Rows:
    """Arrays with first axis B, from which a subset of worlds can be selected."""

    def select(self, index: IntArray) -> Self:
        """Return the worlds ``index``, in that order."""
        changes: dict[str, Any] = {}
        for f in fields(self):  # type: ignore[arg-type]
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and f.name != "angle":
                changes[f.name] = value[index]
            elif isinstance(value, Rows):
                changes[f.name] = value.select(index)
            elif isinstance(value, tuple):
                changes[f.name] = tuple(value[i] for i in index)
        return replace(self, **changes)  # type: ignore[type-var]


@dataclass(frozen=True, eq=False)
class Rays(Rows):
    """The first object that each ray hits; the goal is on a separate layer."""

    angle: FloatArray  # (R,) [rad] from the agent's heading
    distance: FloatArray  # (B, A, R) [m] until the ray (thick: its disc) hits; else the range
    kind: ByteArray  # (B, A, R) of Kind: NOTHING, AGENT, WALL, STATIC, DYNAMIC
    approach: FloatArray  # (B, A, R) [m/s] of the hit dynamic obstacle, towards the agent, else 0
    goal: FloatArray  # (B, A, R) [m] along the ray to the agent's goal; inf if missed or hidden
    radius: FloatArray = _ZERO  # (B, A) [m] of the disc that is cast along a ray; thin: 0
    across: FloatArray = _ZERO  # (B, A, R) [m/s] of the hit dynamic obstacle to the left, else 0

    def __post_init__(self) -> None:
        if self.radius is None:
            object.__setattr__(self, "radius", np.zeros(self.distance.shape[:-1]))
        if self.across is None:
            object.__setattr__(self, "across", np.zeros(self.distance.shape))


@dataclass(frozen=True, eq=False)
class Neighbours(Rows):
    """The nearest other agents and dynamic obstacles in range and in sight, nearest first."""

    position: FloatArray  # (B, A, K, 2) [m]
    velocity: FloatArray  # (B, A, K, 2) [m/s]
    radius: FloatArray  # (B, A, K) [m]; dynamic obstacle: radius of the circumscribed circle
    kind: ByteArray  # (B, A, K) Kind.AGENT or Kind.DYNAMIC
    count: IntArray  # (B, A) valid entries
    # the shape of an agent that is not a disc: a rectangle with rounded corners; else all are zero,
    # and the body is a disc of `radius`; all four arrays are given, or none
    heading: FloatArray = _ZERO  # (B, A, K) [rad]
    half_length: FloatArray = _ZERO  # (B, A, K) [m] half the extent along the heading
    half_width: FloatArray = _ZERO  # (B, A, K) [m] half the extent across the heading
    rounding: FloatArray = _ZERO  # (B, A, K) [m] radius of the corners

    def __post_init__(self) -> None:
        if self.rounding is None:
            vars(self).update(dict.fromkeys(FORM, np.zeros(self.radius.shape)))


@dataclass(frozen=True, eq=False)
class Edges(Rows):
    """The nearest edges of walls and static obstacles that face the agent and are in sight.

    Each runs from start to end with the solid on its left; nearest first. A disc
    is reported as the edges of the regular octagon circumscribed about it.
    """

    start: FloatArray  # (B, A, E, 2) [m]
    end: FloatArray  # (B, A, E, 2) [m]
    before: FloatArray  # (B, A, E, 2) unit direction of the previous edge of its loop
    after: FloatArray  # (B, A, E, 2) unit direction of the next edge of its loop
    start_convex: BoolArray  # (B, A, E) whether the solid is convex at the start
    end_convex: BoolArray  # (B, A, E) whether the solid is convex at the end
    count: IntArray  # (B, A) valid entries
