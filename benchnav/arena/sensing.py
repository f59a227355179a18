"""The sensors of the agents of a world, and their limits."""

from dataclasses import dataclass


@dataclass(frozen=True)
class RaySensor:
    """A fan of rays, symmetric about the heading, outermost rays at its ends."""

    count: int
    fan: float  # [rad] angle between the outermost rays; 2 pi spreads them evenly all round
    range: float  # [m]
    thick: bool  # True: sphere casts of the agent's own radius


@dataclass(frozen=True)
class NeighbourSensor:
    """The nearest agents and dynamic obstacles, by distance between centres."""

    count: int
    range: float  # [m]


@dataclass(frozen=True)
class EdgeSensor:
    """The nearest edges of walls and static obstacles, by distance to the agent's centre."""

    count: int
    range: float  # [m]


@dataclass(frozen=True)
class Sensing:
    """The sensors of every agent of a world; None for a missing kind."""

    rays: RaySensor | None
    neighbours: NeighbourSensor | None
    edges: EdgeSensor | None
    occlusion: bool = True  # neighbours and edges hidden by walls and obstacles are not sensed
