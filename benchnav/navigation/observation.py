"""What the agents of one navigator perceive now, for a batch of worlds.

Arrays start with (B, A): the worlds of this call and the agents that this
navigator drives, padded; everybody else is a neighbour. World frame. Sensors
that the navigator does not need are None.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Self

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.navigation.map import Map


class _Rows:
    """Takes a subset of worlds from every array whose first axis is B."""

    def select(self, index: IntArray) -> Self:
        changes: dict[str, Any] = {}
        for f in fields(self):  # type: ignore[arg-type]
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and f.name != "angle":
                changes[f.name] = value[index]
            elif isinstance(value, _Rows):
                changes[f.name] = value.select(index)
            elif isinstance(value, tuple):
                changes[f.name] = tuple(value[i] for i in index)
        return replace(self, **changes)  # type: ignore[type-var]


@dataclass(frozen=True, eq=False)
class Rays(_Rows):
    """What each ray meets first; the goal is on a layer of its own."""

    angle: FloatArray  # (R,) [rad] from the agent's heading
    distance: FloatArray  # (B, A, R) [m] travelled by the ray or its disc; range if nothing
    kind: ByteArray  # (B, A, R) of Kind: NOTHING, AGENT, WALL, STATIC, DYNAMIC
    approach: FloatArray  # (B, A, R) [m/s] of the mover that is met, towards the agent, else 0
    goal: FloatArray  # (B, A, R) [m] to the own goal's disc along the ray; inf if missed or hidden


@dataclass(frozen=True, eq=False)
class Neighbours(_Rows):
    """The nearest other agents and dynamic obstacles in range and in sight, nearest first."""

    position: FloatArray  # (B, A, K, 2) [m]
    velocity: FloatArray  # (B, A, K, 2) [m/s]
    radius: FloatArray  # (B, A, K) [m] (dynamic obstacles: circumscribed)
    kind: ByteArray  # (B, A, K) Kind.AGENT or Kind.DYNAMIC
    count: IntArray  # (B, A) valid entries


@dataclass(frozen=True, eq=False)
class Edges(_Rows):
    """The nearest edges of walls and static obstacles that face the agent and are in sight.

    Each runs from start to end with the solid on its left; nearest first. A disc
    is seen as the edges of the regular octagon circumscribed about it.
    """

    start: FloatArray  # (B, A, E, 2) [m]
    end: FloatArray  # (B, A, E, 2) [m]
    before: FloatArray  # (B, A, E, 2) unit direction of the previous edge of its loop
    after: FloatArray  # (B, A, E, 2) unit direction of the next edge of its loop
    start_convex: BoolArray  # (B, A, E)
    end_convex: BoolArray  # (B, A, E)
    count: IntArray  # (B, A) valid entries


@dataclass(frozen=True, eq=False)
class Observation(_Rows):
    """One decision's view."""

    rows: IntArray  # (B,) the row that `reset` gave each world
    time: FloatArray  # (B,) [s]
    active: BoolArray  # (B, A) whose commands count; the rest is padding or done
    position: FloatArray  # (B, A, 2) [m]
    heading: FloatArray  # (B, A) [rad]
    velocity: FloatArray  # (B, A, 2) [m/s] as executed in the last step
    goal: FloatArray  # (B, A, 2) [m]
    maps: tuple[Map | None, ...]  # (B,) as the track grants it now
    rays: Rays | None = None
    neighbours: Neighbours | None = None
    edges: Edges | None = None

    def __len__(self) -> int:
        return len(self.rows)


def arrays_of(part: object) -> dict[str, AnyArray]:
    """Name → array of an observation part, for tests and for messages."""
    return {
        f.name: getattr(part, f.name)
        for f in fields(part)  # type: ignore[arg-type]
        if isinstance(getattr(part, f.name), np.ndarray)
    }
