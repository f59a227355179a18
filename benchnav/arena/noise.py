"""The noise of the senses in the perception track `noisy`; all numbers zero: the senses are exact.

`benchnav.scenario.noise` holds the defaults and their sources.
"""

from dataclasses import dataclass, field

from benchnav.geometry.rotation import TWO_PI


@dataclass(frozen=True)
class RayNoise:
    """Errors of rays. The standard deviation at distance d is n + r d + q d²."""

    noise: float = 0.0  # n [m]
    relative_noise: float = 0.0  # r [1]
    quadratic_noise: float = 0.0  # q [1/m]
    dropout: float = 0.0  # probability that a ray returns nothing
    approach_noise: float = 0.0  # [m/s] standard deviation of `approach` and `across`
    field_of_view: float = TWO_PI  # [rad] about the heading; a ray outside returns nothing


@dataclass(frozen=True)
class NeighbourNoise:
    """Errors of neighbours."""

    position_noise: float = 0.0  # [m] standard deviation of each coordinate
    velocity_noise: float = 0.0  # [m/s] standard deviation of each component
    missed: float = 0.0  # probability that a neighbour is not reported
    false_alarms: float = 0.0  # probability that a neighbour is reported that does not exist
    field_of_view: float = TWO_PI  # [rad] about the heading


@dataclass(frozen=True)
class EdgeNoise:
    """Errors of edges."""

    offset_noise: float = 0.0  # [m] standard deviation of the shift along an edge's normal
    missed: float = 0.0  # probability that an edge is not reported
    field_of_view: float = TWO_PI  # [rad] about the heading


@dataclass(frozen=True)
class OdometryNoise:
    """Errors of the own pose: a random walk with the motion, and corrections from outside."""

    distance_noise: float = 0.0  # [m] standard deviation along the path after 1 m, grows as √m
    heading_noise: float = 0.0  # [rad] standard deviation after 1 m of driving, grows as √m
    turning_noise: float = 0.0  # [rad] standard deviation after 1 rad of turning, grows as √rad
    correction_period: float | None = None  # [s] between corrections; None: there are none
    correction_position_noise: float = 0.0  # [m] standard deviation of each coordinate
    correction_heading_noise: float = 0.0  # [rad] standard deviation


@dataclass(frozen=True)
class Noise:
    """All errors of the senses of every evaluated agent of a scenario."""

    rays: RayNoise = field(default_factory=RayNoise)
    neighbours: NeighbourNoise = field(default_factory=NeighbourNoise)
    edges: EdgeNoise = field(default_factory=EdgeNoise)
    odometry: OdometryNoise = field(default_factory=OdometryNoise)
    delay: int = 0  # decisions by which rays, neighbours and edges are late
