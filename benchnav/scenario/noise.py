"""The errors of the sensors in the perception track `noisy`, with presets of published sensors.

Sources of the presets:

- Rays, `lidar`: a low-cost scanner. Slamtec RPLIDAR A1, datasheet rev. 1.0: the resolution is
  better than 0.5 mm below 1.5 m, and 1 % of the distance in the whole range; here, 1 % is taken for
  a standard deviation. `dropout` is the share of readings without a return in the beam model of
  the localisation AMCL (ROS 1, default of `laser_z_max`: 0.05; Thrun, Burgard and Fox,
  Probabilistic Robotics, 2005, section 6.3). The 5 mm and `approach_noise` are chosen.
- Rays, `depth-camera`: Intel RealSense D435, datasheet of 2020: 87° ± 3° horizontal field of view
  of depth. The error of stereo depth is d² s / (f b) (Keselman et al., Intel RealSense Stereoscopic
  Depth Cameras, CVPR Workshops 2017, equation 2), with a focal length f = 447 pixels (848 pixels
  over 87°) and a baseline b = 0.05 m. The error of disparity s = 0.08 pixels and the 2 mm are
  chosen; `dropout` and `approach_noise` are those of `lidar`.
- Neighbours, `people-tracker`: a tracker with a 2D lidar on a moving robot has an accuracy (MOTA)
  of 85 %: misses, false alarms and swaps together are 15 % (Plozza et al., Autonomous Navigation
  in Dynamic Human Environments with an Embedded 2D LiDAR-based Person Tracker, IEEE SAS 2024).
  Their split into 10 % misses and 5 % false alarms is chosen, and so are the deviations: that of
  the position is about the radius of a leg.
- Edges: all numbers are chosen.
- Odometry: the variance grows in proportion to the path (Siegwart and Nourbakhsh, Introduction to
  Autonomous Mobile Robots, 2004, section 5.2.4). The numbers are chosen: after 10 m straight ahead,
  the error is 1 % of the path along it and 4 % across it. The corrections are those of a
  localisation on a map; their errors are chosen, and larger than those of careful evaluations (a
  centimetre and a degree: Costa et al., Robust and Accurate Localization System for Mobile
  Manipulators in Cluttered Environments, ICIT 2015).
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field, model_validator

from benchnav.scenario.base import FAR, Spec

_CAMERA = math.radians(87.0)
_ROUND = 2.0 * math.pi
_MOST = 10_000  # decisions of a delay


def _deviation(default: float, text: str) -> Any:
    return Field(default, ge=0, le=FAR, description=f"standard deviation {text}")


def _probability(default: float, text: str) -> Any:
    return Field(default, ge=0, le=1, description=f"probability that {text}")


def _view(text: str) -> Any:
    return Field(
        _ROUND, gt=0, le=_ROUND, description=f"angle [rad] about the heading in which {text}"
    )


class _Sensor(Spec):
    """The errors of one sensor; a preset gives the numbers that are left out."""

    presets: ClassVar[Mapping[str, Mapping[str, float | None]]] = {}

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        preset = cls.presets.get(str(data.get("sensor")), {})
        return {**preset, **data}

    @property
    def numbers(self) -> dict[str, Any]:
        """All keys but the name of the preset."""
        return self.model_dump(exclude={"sensor"})


class RayErrors(_Sensor):
    """The errors of rays. The deviation at distance d is noise + relative d + quadratic d²."""

    presets: ClassVar[Mapping[str, Mapping[str, float | None]]] = {
        "exact": {"noise": 0.0, "relative_noise": 0.0, "dropout": 0.0, "approach_noise": 0.0},
        "depth-camera": {
            "noise": 0.002, "relative_noise": 0.0, "quadratic_noise": 0.0036,
            "field_of_view": _CAMERA,
        },
    }  # fmt: skip

    sensor: Literal["exact", "lidar", "depth-camera"] = Field(
        "lidar", description="preset that gives the other keys"
    )
    noise: float = _deviation(0.005, "[m] at any distance")
    relative_noise: float = _deviation(0.01, "as a share of the distance")
    quadratic_noise: float = _deviation(
        0.0, "[m] at 1 m of a part that grows with the squared distance"
    )
    dropout: float = _probability(0.05, "a ray returns nothing")
    approach_noise: float = _deviation(
        0.1, "[m/s] of the speeds towards the agent and across the ray"
    )
    field_of_view: float = _view("rays return something")


class NeighbourErrors(_Sensor):
    """The errors of neighbours."""

    presets: ClassVar[Mapping[str, Mapping[str, float | None]]] = {
        "exact": {
            "position_noise": 0.0, "velocity_noise": 0.0, "missed": 0.0, "false_alarms": 0.0,
        },
        "depth-camera": {"field_of_view": _CAMERA},
    }  # fmt: skip

    sensor: Literal["exact", "people-tracker", "depth-camera"] = Field(
        "people-tracker", description="preset that gives the other keys"
    )
    position_noise: float = _deviation(0.1, "[m] of each coordinate")
    velocity_noise: float = _deviation(0.15, "[m/s] of each component")
    missed: float = _probability(0.1, "a neighbour is not reported")
    false_alarms: float = _probability(0.05, "one more neighbour is reported that does not exist")
    field_of_view: float = _view("neighbours are seen")


class EdgeErrors(_Sensor):
    """The errors of edges."""

    presets: ClassVar[Mapping[str, Mapping[str, float | None]]] = {
        "exact": {"offset_noise": 0.0, "missed": 0.0},
        "depth-camera": {"offset_noise": 0.02, "field_of_view": _CAMERA},
    }

    sensor: Literal["exact", "lidar", "depth-camera"] = Field(
        "lidar", description="preset that gives the other keys"
    )
    offset_noise: float = _deviation(0.01, "[m] of the shift along the normal of an edge")
    missed: float = _probability(0.02, "an edge is not reported")
    field_of_view: float = _view("edges are seen")


class OdometryErrors(_Sensor):
    """The errors of the own pose: a random walk with the motion, and corrections from outside."""

    presets: ClassVar[Mapping[str, Mapping[str, float | None]]] = {
        "exact": {
            "distance_noise": 0.0, "heading_noise": 0.0, "turning_noise": 0.0,
            "correction_period": None,
        },
        "dead-reckoning": {"correction_period": None},
    }  # fmt: skip

    sensor: Literal["exact", "corrected", "dead-reckoning"] = Field(
        "corrected", description="preset that gives the other keys"
    )
    distance_noise: float = _deviation(0.03, "[m] along the path after 1 m; it grows as √m")
    heading_noise: float = _deviation(0.02, "[rad] after 1 m; it grows as √m")
    turning_noise: float = _deviation(0.02, "[rad] after a turn by 1 rad; it grows as √rad")
    correction_period: float | None = Field(
        5.0, gt=0, le=1e5, description="time [s] between corrections of the pose; `null`: none"
    )
    correction_position_noise: float = _deviation(0.05, "[m] of each coordinate of a correction")
    correction_heading_noise: float = _deviation(0.02, "[rad] of the heading of a correction")


class NoiseSpec(Spec):
    """The errors of the sensors in the perception track `noisy`."""

    rays: RayErrors = Field(RayErrors(), description="errors of rays")
    neighbours: NeighbourErrors = Field(NeighbourErrors(), description="errors of neighbours")
    edges: EdgeErrors = Field(EdgeErrors(), description="errors of edges")
    odometry: OdometryErrors = Field(OdometryErrors(), description="errors of the own pose")
    delay: int = Field(
        1,
        ge=0,
        le=_MOST,
        description="decisions by which rays, neighbours and edges are late; the own pose is not",
    )
