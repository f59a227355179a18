"""A ROS 2 node that publishes what the navigator sends, and returns `cmd_vel`.

Untried: no ROS 2 was at hand when this was written. Its fields and calls follow the documentation
of rclpy and rosidl_runtime_py. It needs Python 3.10 and ROS 2 Humble or newer, and no benchnav.
"""

from time import monotonic
from typing import Any

import rclpy
from channel import Channel, ChannelError, serve
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosidl_runtime_py import message_to_ordereddict, set_message_fields
from rosidl_runtime_py.utilities import get_message

RELIABLE = QoSProfile(depth=10)  # REP 2003: sensors publish reliably, their readers need not
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for late readers
NEWEST = QoSProfile(depth=1)
PAUSE = 1.0  # [s] of ROS time between two episodes, which never goes back


class Bridge:
    """One node for all robots; it makes publishers and subscriptions as requests name them."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("benchnav_bridge")
        self.socket = self.node.declare_parameter("socket", "/tmp/benchnav.sock").value  # noqa: S108
        self.patience = self.node.declare_parameter("command_timeout", 2.0).value
        self._outgoing, self._incoming, self._received = {}, {}, {}
        self._now = 0  # [ns] ROS time

    def drive(self, channel: Channel) -> None:
        """Serve one episode. Raises ChannelError when it ends."""
        channel.send({"start": self._now * 1e-9 + PAUSE if self._now else 0.0})
        while True:
            request = channel.receive()
            self._listen(request["await"])
            for each in request["publish"]:  # the clock comes last
                self._publish(each["topic"], get_message(each["type"]), each["message"])
            channel.send({"received": self._wait(set(request["await"]))})

    def _listen(self, topics: dict) -> None:
        """Subscribe to the topics, and drop the messages that came before this decision."""
        for topic, kind in topics.items():
            if topic not in self._incoming:
                self._incoming[topic] = self.node.create_subscription(
                    get_message(kind), topic, lambda m, t=topic: self._receive(t, m), NEWEST
                )
            rclpy.spin_once(self.node, timeout_sec=0.0)
        self._received.clear()

    def _receive(self, topic: str, message: Any) -> None:
        """Keep a message, unless its stamp is that of an earlier decision."""
        stamp = _nanoseconds(message.header.stamp) if hasattr(message, "header") else 0
        if not stamp or stamp >= self._now:
            self._received[topic] = message_to_ordereddict(message)

    def _publish(self, topic: str, kind: type, fields: dict) -> None:
        if topic not in self._outgoing:
            profile = LATCHED if topic.endswith("/goal_pose") else RELIABLE
            self._outgoing[topic] = self.node.create_publisher(kind, topic, profile)
        message = kind()
        set_message_fields(message, fields)
        self._outgoing[topic].publish(message)
        if topic == "/clock":
            self._now = _nanoseconds(message.clock)

    def _wait(self, topics: set) -> dict:
        """Return the messages that come on these topics within ``command_timeout``."""
        deadline = monotonic() + self.patience
        while topics - set(self._received) and (left := deadline - monotonic()) > 0:
            rclpy.spin_once(self.node, timeout_sec=left)
        return {topic: self._received[topic] for topic in topics & set(self._received)}


def _nanoseconds(time: Any) -> int:
    return time.sec * 10**9 + time.nanosec


def main() -> None:
    """Serve until the process is stopped."""
    rclpy.init()
    bridge = Bridge()
    try:
        serve(bridge.socket, bridge.drive)
    except (KeyboardInterrupt, ChannelError):
        pass
    finally:
        bridge.node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
