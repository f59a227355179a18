"""The sensors of the agents of a world, and their limits."""

from dataclasses import dataclass
from enum import IntEnum


class RayCircle(IntEnum):
    """The circle of the body that is cast along a ray."""

    POINT = 0  # none: a thin ray
    INSCRIBED = 1  # the largest circle within the footprint
    CIRCUMSCRIBED = 2  # the smallest circle around the footprint


@dataclass(frozen=True)
class RaySensor:
    """A fan of rays, symmetric about the heading, outermost rays at its ends."""

    count: int
    fan: float  # [rad] angle between the outermost rays; 2 pi spreads them evenly all round
    range: float  # [m]
    thick: bool  # True: sphere casts of the agent's own body
    circumscribed: bool = False  # thick rays cast the circle around a footprint, not that within

    @property
    def circle(self) -> RayCircle:
        """The circle that is cast."""
        if not self.thick:
            return RayCircle.POINT
        return RayCircle.CIRCUMSCRIBED if self.circumscribed else RayCircle.INSCRIBED

    def left_out(self) -> frozenset[str]:
        """Return the names of the fields that are not hashed or stored: added, and at default."""
        return frozenset() if self.circumscribed else frozenset({"circumscribed"})


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
