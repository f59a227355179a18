"""Observations as ROS 2 messages: fields, units, frames, and every bit of the numbers."""

import importlib.util
import json
import math
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "ros2_controller"


def load(name):
    """The module of the example, without adding its folder to the import path."""
    found = importlib.util.spec_from_file_location(f"ros2_example_{name}", EXAMPLE / f"{name}.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


messages = load("messages")

# Fields of the types, from common_interfaces, builtin_interfaces, rosgraph_msgs, tf2_msgs and
# people_msgs. A list holds elements of its type; text and numbers are Python types.
XYZ = {"x": float, "y": float, "z": float}
XYZW = {**XYZ, "w": float}
TIME = {"sec": int, "nanosec": int}
HEADER = {"stamp": TIME, "frame_id": str}
POSE = {"position": XYZ, "orientation": XYZW}
TWIST = {"linear": XYZ, "angular": XYZ}
TYPES = {
    "clock": {"clock": TIME},
    "odometry": {
        "header": HEADER, "child_frame_id": str, "pose": {"pose": POSE, "covariance": [float]},
        "twist": {"twist": TWIST, "covariance": [float]},
    },
    "scan": {
        "header": HEADER, "angle_min": float, "angle_max": float, "angle_increment": float,
        "time_increment": float, "scan_time": float, "range_min": float, "range_max": float,
        "ranges": [float], "intensities": [float],
    },
    "transforms": {
        "transforms": [
            {
                "header": HEADER, "child_frame_id": str,
                "transform": {"translation": XYZ, "rotation": XYZW},
            }
        ]
    },
    "goal": {"header": HEADER, "pose": POSE},
    "people": {
        "header": HEADER,
        "people": [
            {
                "name": str, "position": XYZ, "velocity": XYZ, "reliability": float,
                "tagnames": [str], "tags": [str],
            }
        ],
    },
}  # fmt: skip
ANGLE = np.linspace(-math.pi / 2, math.pi / 2, 5)
DISTANCE = np.array([0.1, 2.0, 8.0, 1 / 3, 7.5])
KIND = np.array([2, 1, 0, 3, 5], np.int8)
POINT = np.array([1 / 3, -2.0])
EXAMPLES = {
    "clock": messages.clock(1.2),
    "odometry": messages.odometry(1.2, POINT, 2.0, np.array([0.3, 0.1]), 0.5),
    "scan": messages.scan(1.2, ANGLE, DISTANCE, KIND, 8.0, 0.2),
    "transforms": messages.transforms(1.2, POINT, 2.0),
    "goal": messages.goal(1.2, POINT, 2.0),
    "people": messages.people(
        1.2, np.array([[1.0, 2.0]]), np.array([[0.5, -0.5]]), np.array([1]), np.array([0.3])
    ),
}  # fmt: skip


def conform(value, kind, place):
    if isinstance(kind, dict):
        assert set(value) <= set(kind), place
        for name in value:
            conform(value[name], kind[name], f"{place}.{name}")
    elif isinstance(kind, list):
        for each in value:
            conform(each, kind[0], f"{place}[]")
    else:
        assert type(value) is kind, place


@pytest.mark.parametrize("name", TYPES)
def test_every_field_is_one_of_the_type_in_ros(name):
    conform(EXAMPLES[name], TYPES[name], name)


@pytest.mark.parametrize("name", TYPES)
def test_a_message_keeps_its_bits_on_the_way(name):
    assert json.loads(json.dumps(EXAMPLES[name])) == EXAMPLES[name]


def test_time_has_whole_nanoseconds():
    assert messages.time(1.2) == {"sec": 1, "nanosec": 200_000_000}
    assert messages.time(2.9999999999) == {"sec": 3, "nanosec": 0}


def test_a_pose_is_in_odom_and_a_twist_in_the_body():
    message = EXAMPLES["odometry"]
    assert (message["header"]["frame_id"], message["child_frame_id"]) == ("odom", "base_link")
    pose = message["pose"]["pose"]
    assert pose["position"] == {"x": 1 / 3, "y": -2.0, "z": 0.0}
    assert pose["orientation"] == {"x": 0.0, "y": 0.0, "z": math.sin(1.0), "w": math.cos(1.0)}
    linear = message["twist"]["twist"]["linear"]
    assert linear["x"] == 0.3 * math.cos(2.0) + 0.1 * math.sin(2.0)
    assert linear["y"] == 0.1 * math.cos(2.0) - 0.3 * math.sin(2.0)
    assert message["twist"]["twist"]["angular"] == {"z": 0.5}


def test_the_frames_form_one_tree():
    pairs = [
        (each["header"]["frame_id"], each["child_frame_id"])
        for each in EXAMPLES["transforms"]["transforms"]
    ]
    assert pairs == [("map", "odom"), ("odom", "base_link")]


def test_a_ray_that_hits_nothing_is_infinite():
    message = EXAMPLES["scan"]
    expected = [0.1, 2.0, math.inf, 1 / 3, 7.5]
    assert message["ranges"] == [float(np.float32(value)) for value in expected]
    assert message["angle_min"] == -math.pi / 2
    assert message["angle_increment"] == math.pi / 4
    assert message["header"]["frame_id"] == "base_link"
    one = messages.scan(0.0, np.zeros(1), np.ones(1), np.ones(1, np.int8), 8.0, 0.2)
    assert one["angle_increment"] == 0.0


@pytest.mark.parametrize(("range_max", "length"), [(7.0, "8"), (9.0, "8")])
def test_the_range_must_be_that_of_the_rays(range_max, length):
    with pytest.raises(ValueError, match=f"Got {range_max:g} m, but a ray is {length} m long"):
        messages.scan(0.0, ANGLE, DISTANCE, KIND, range_max, 0.2)


def test_people_have_velocities_and_sizes():
    (person,) = EXAMPLES["people"]["people"]
    assert person["velocity"] == {"x": 0.5, "y": -0.5, "z": 0.0}
    assert dict(zip(person["tagnames"], person["tags"], strict=True)) == {
        "kind": "robot", "radius": "0.3",
    }  # fmt: skip


def test_both_kinds_of_twist_are_read():
    twist = {"linear": {"x": 0.1, "y": 0.0}, "angular": {"z": -0.2}}
    assert messages.twist(twist) == messages.twist({"header": {}, "twist": twist}) == (0.1, -0.2)


@pytest.mark.parametrize("wrong", [{}, {"twist": 1}, {"linear": {"x": "fast"}, "angular": {}}, 3])
def test_anything_else_is_refused(wrong):
    with pytest.raises(ValueError, match=r"must be a Twist or a TwistStamped\. Got"):
        messages.twist(wrong)
