"""Observations of benchnav as ROS 2 messages, and `cmd_vel` as a command.

A message is a dict with the fields of its ROS type, so this module needs no ROS. Fields that are
left out keep the default values of ROS: zero, or empty. Units and axes follow REP 103 (metres,
seconds, radians; x forward, y left), frames REP 105, missing ranges REP 117. benchnav uses the same
units and axes, so no number is converted but headings (to quaternions) and ranges (to float32).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

Message = dict[str, Any]
NOTHING = 0  # kind of a ray that hit nothing
KINDS = {1: "robot", 5: "obstacle"}  # kinds of neighbours
MAP, ODOM, BASE = "map", "odom", "base_link"


def publication(topic: str, kind: str, message: Message) -> Message:
    """Return a message with its topic and its type, for example ``nav_msgs/msg/Odometry``."""
    return {"topic": topic, "type": kind, "message": message}


def time(seconds: float) -> Message:
    """Return a builtin_interfaces/Time."""
    whole, rest = divmod(round(seconds * 1e9), 10**9)
    return {"sec": whole, "nanosec": rest}


def clock(seconds: float) -> Message:
    """Return a rosgraph_msgs/Clock."""
    return {"clock": time(seconds)}


def odometry(
    seconds: float, position: np.ndarray, heading: float, velocity: np.ndarray, turn_rate: float
) -> Message:
    """Return a nav_msgs/Odometry: the pose in the frame odom, the twist in the frame base_link.

    Args:
        seconds: [s] ROS time.
        position: (2,) [m].
        heading: [rad].
        velocity: (2,) [m/s] in the world frame.
        turn_rate: [rad/s].
    """
    cos, sin = math.cos(heading), math.sin(heading)
    forward = float(velocity[0] * cos + velocity[1] * sin)
    leftward = float(velocity[1] * cos - velocity[0] * sin)
    return {
        "header": _header(seconds, ODOM),
        "child_frame_id": BASE,
        "pose": {"pose": _pose(position, heading)},
        "twist": {"twist": {"linear": _vector((forward, leftward)), "angular": {"z": turn_rate}}},
    }


def transforms(seconds: float, position: np.ndarray, heading: float) -> Message:
    """Return a tf2_msgs/TFMessage: map to odom (the identity), and odom to base_link."""
    steps = ((MAP, ODOM, (0.0, 0.0), 0.0), (ODOM, BASE, position, heading))
    return {
        "transforms": [
            {
                "header": _header(seconds, parent), "child_frame_id": child,
                "transform": {"translation": _vector(shift), "rotation": _quaternion(turn)},
            }
            for parent, child, shift, turn in steps
        ]
    }  # fmt: skip


def scan(
    seconds: float, angle: np.ndarray, distance: np.ndarray, kind: np.ndarray, range_max: float,
    period: float,
) -> Message:  # fmt: skip
    """Return a sensor_msgs/LaserScan; a ray that hits nothing has the range +inf (REP 117).

    Args:
        seconds: [s] ROS time.
        angle: (R,) [rad] from the heading, evenly spaced.
        distance: (R,) [m] as in `Rays`.
        kind: (R,) as in `Rays`.
        range_max: [m] of the sensor.
        period: [s] between two scans.

    Raises ValueError if ``range_max`` is not the range of the rays.
    """
    empty = kind == NOTHING
    wrong = distance[np.where(empty, distance != range_max, distance > range_max)]
    if len(wrong):
        raise ValueError(
            f"range_max must be the range of the scenario's rays. Got {range_max:g} m,"
            f" but a ray is {wrong[0]:g} m long"
        )
    ranges = np.where(empty, np.inf, distance).astype(np.float32)
    increment = float(angle[-1] - angle[0]) / (len(angle) - 1) if len(angle) > 1 else 0.0
    return {
        "header": _header(seconds, BASE), "scan_time": period,
        "angle_min": float(angle[0]), "angle_max": float(angle[-1]), "angle_increment": increment,
        "range_min": 0.0, "range_max": range_max, "ranges": ranges.astype(np.float64).tolist(),
    }  # fmt: skip


def goal(seconds: float, position: np.ndarray, heading: float) -> Message:
    """Return a geometry_msgs/PoseStamped in the frame map."""
    return {"header": _header(seconds, MAP), "pose": _pose(position, heading)}


def people(
    seconds: float, position: np.ndarray, velocity: np.ndarray, kind: np.ndarray, radius: np.ndarray
) -> Message:
    """Return a people_msgs/People in the frame map: the K sensed neighbours, nearest first."""
    return {
        "header": _header(seconds, MAP),
        "people": [
            {
                "name": str(k), "position": _vector(position[k]), "velocity": _vector(velocity[k]),
                "reliability": 1.0, "tagnames": ["kind", "radius"],
                "tags": [KINDS[int(kind[k])], repr(float(radius[k]))],
            }
            for k in range(len(position))
        ],
    }  # fmt: skip


def twist(message: Message) -> tuple[float, float]:
    """Return (forward speed [m/s], turn rate [rad/s]) of a Twist or a TwistStamped.

    Raises ValueError if it is neither, or moves sideways.
    """
    try:
        content = message.get("twist", message)
        linear, angular = content["linear"], content["angular"]
        forward, sideways = float(linear["x"]), float(linear.get("y", 0.0))
        turn_rate = float(angular["z"])
    except (AttributeError, KeyError, TypeError, ValueError):
        raise ValueError(
            f"cmd_vel must be a Twist or a TwistStamped. Got {str(message)[:100]} instead"
        ) from None
    if sideways != 0.0:
        raise ValueError(
            "cmd_vel must have linear.y = 0, because the body cannot move sideways."
            f" Got {sideways:g} m/s"
        )
    return forward, turn_rate


def _header(seconds: float, frame: str) -> Message:
    return {"stamp": time(seconds), "frame_id": frame}


def _vector(xy: np.ndarray | Sequence[float]) -> Message:
    return {"x": float(xy[0]), "y": float(xy[1]), "z": 0.0}


def _quaternion(yaw: float) -> Message:
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}


def _pose(position: np.ndarray, heading: float) -> Message:
    return {"position": _vector(position), "orientation": _quaternion(heading)}
