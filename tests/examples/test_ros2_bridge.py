"""The node with rclpy, run with stand-ins for ROS: its own logic, and not that of ROS 2."""

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from tests.examples.test_ros2_messages import load

EXAMPLE = Path(__file__).parents[2] / "examples" / "ros2_controller"


class Graph:
    """A node, and a controller that answers each scan with the twists in ``answers``."""

    def __init__(self):
        self.published, self.readers, self.queue = [], {}, []
        self.answers = []

    def create_node(self, name):
        return self

    def declare_parameter(self, name, value):
        return SimpleNamespace(value=0.05 if name == "command_timeout" else value)

    def create_publisher(self, kind, topic, profile):
        return SimpleNamespace(publish=lambda message: self.publish(topic, message, profile))

    def publish(self, topic, message, profile):
        self.published.append((topic, profile))
        if topic == "/clock":
            self.queue += [("/robot_0/cmd_vel", answer) for answer in self.answers]

    def create_subscription(self, kind, topic, callback, profile):
        self.readers[topic] = callback

    def spin_once(self, node, timeout_sec):
        if self.queue:
            topic, message = self.queue.pop(0)
            self.readers[topic](message)


def message(seconds, speed):
    stamp = SimpleNamespace(sec=seconds, nanosec=0)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), speed=speed)


def fill(made, fields):
    made.clock = SimpleNamespace(**fields.get("clock", {}))


@pytest.fixture
def graph(monkeypatch):
    graph = Graph()
    quality = {"DurabilityPolicy": SimpleNamespace(TRANSIENT_LOCAL="latched"), "QoSProfile": dict}
    modules = {
        "rclpy": {"create_node": graph.create_node, "spin_once": graph.spin_once},
        "rclpy.qos": quality,
        "rosidl_runtime_py": {
            "message_to_ordereddict": lambda m: {"speed": m.speed}, "set_message_fields": fill,
        },
        "rosidl_runtime_py.utilities": {"get_message": lambda name: SimpleNamespace},
    }  # fmt: skip
    for name, content in modules.items():
        module = ModuleType(name)
        module.__dict__.update(content)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setitem(sys.modules, "channel", load("channel"))
    graph.bridge = load("bridge_node").Bridge()
    return graph


class Requests:
    """A channel with the requests of an episode, which ends with a lost connection."""

    def __init__(self, *requests):
        self.requests, self.sent = list(requests), []

    def send(self, answer):
        self.sent.append(answer)

    def receive(self):
        if not self.requests:
            raise sys.modules["channel"].ChannelError("closed")
        return self.requests.pop(0)


def decision(seconds):
    clock = {
        "topic": "/clock",
        "type": "Clock",
        "message": {"clock": {"sec": seconds, "nanosec": 0}},
    }
    goal = {"topic": "/robot_0/goal_pose", "type": "PoseStamped", "message": {}}
    return {"publish": [goal, clock], "await": {"/robot_0/cmd_vel": "TwistStamped"}}


def drive(graph, *requests):
    channel = Requests(*requests)
    with pytest.raises(sys.modules["channel"].ChannelError):
        graph.bridge.drive(channel)
    return channel.sent


def test_it_returns_the_twist_that_belongs_to_the_decision(graph):
    graph.answers = [message(4, "old"), message(5, "new")]
    assert drive(graph, decision(5)) == [
        {"start": 0.0}, {"received": {"/robot_0/cmd_vel": {"speed": "new"}}},
    ]  # fmt: skip
    assert dict(graph.published)["/robot_0/goal_pose"]["durability"] == "latched"


def test_a_late_twist_is_not_taken_for_the_next_decision(graph):
    graph.answers = [message(5, "first"), message(5, "late")]
    _, first, second = drive(graph, decision(5), decision(6))
    assert first == {"received": {"/robot_0/cmd_vel": {"speed": "first"}}}
    assert second == {"received": {}}


def test_it_waits_no_longer_than_the_timeout(graph):
    assert drive(graph, decision(5)) == [{"start": 0.0}, {"received": {}}]


def test_the_clock_does_not_go_back_between_episodes(graph):
    drive(graph, decision(5))
    assert drive(graph) == [{"start": 6.0}]
