"""A navigator that asks a ROS 2 node for every command; benchnav starts it as a `process`.

Each decision is one exchange with the node: poses, scan and clock go out, and `cmd_vel` of every
robot comes back. Tested with `stub_node.py`; the ROS 2 node, `bridge_node.py`, is untried.
"""

import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from pydantic import Field, field_validator

sys.path.insert(0, str(Path(__file__).parent))

import messages
from channel import Channel, ChannelError, connect

from benchnav.errors import NavigatorError
from benchnav.isolation import host
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.navigator import Navigator, Need, PluginConfig
from benchnav.navigation.observation import Observation

TWISTS = {True: "geometry_msgs/msg/TwistStamped", False: "geometry_msgs/msg/Twist"}


class Ros2Controller(Navigator):
    """Publishes what the robots perceive, and drives them by `cmd_vel`."""

    command = "twist"
    uses_map = False

    class Config(PluginConfig):
        """Parameters."""

        socket: str = Field(description="absolute path of the socket at which the node listens")
        timeout: float = Field(10.0, gt=0, description="[s] time limit of an answer of the node")
        stamped: bool = Field(True, description="whether cmd_vel is a TwistStamped, or a Twist")
        missing: Literal["stop", "hold", "fail"] = Field(
            "stop", description="what a robot does in a decision without cmd_vel"
        )
        range_max: float = Field(8.0, gt=0, description="[m] range of the scenario's rays")
        people: bool = Field(False, description="whether to publish neighbours as people")
        reproducible: bool = Field(
            False, description="whether equal messages give equal commands at any speed"
        )

        @field_validator("socket")
        @classmethod
        def _check_socket(cls, path: str) -> str:
            if not Path(path).is_absolute():
                raise ValueError("an absolute path, because the program starts in another folder")
            return path

    def __init__(self, config: Config | None = None) -> None:
        super().__init__(config)
        self._channel: Channel | None = None
        self._missed = 0  # cmd_vel of this episode that did not come
        try:
            self._connect().close()
        except ChannelError as error:
            raise NavigatorError(str(error)) from None

    @property
    def required(self) -> frozenset[Need]:
        return frozenset({Need.RAYS, *((Need.NEIGHBOURS,) if self.config.people else ())})

    @property
    def reproducible(self) -> bool:
        return self.config.reproducible

    def reset(self, briefings: Sequence[Briefing], rows: np.ndarray) -> None:
        self._disconnect()
        _require_one_world(rows)
        (self._briefing,) = briefings
        self._heading, self._missed = self._briefing.heading.copy(), 0
        self._command = np.zeros((1, len(self._briefing), 2))
        way = self._briefing.goal - self._briefing.start
        try:
            self._channel = self._connect()
            self._exchange(
                messages.publication(
                    f"/robot_{k}/goal_pose", "geometry_msgs/msg/PoseStamped",
                    messages.goal(self._start, self._briefing.goal[k], math.atan2(y, x)),
                )
                for k, (x, y) in enumerate(way.tolist())
            )  # fmt: skip
        except ChannelError as error:
            raise CallFailed(f"reset: {error}") from None

    def act(self, observation: Observation) -> np.ndarray:
        _require_one_world(observation.rows)
        robots = np.flatnonzero(observation.active[0]).tolist()
        topics = {f"/robot_{k}/cmd_vel": TWISTS[self.config.stamped] for k in robots}
        try:
            published = [p for k in robots for p in self._robot(observation, k)]
            now = self._start + float(observation.time[0])
            tick = messages.publication("/clock", "rosgraph_msgs/msg/Clock", messages.clock(now))
            received = self._exchange([*published, tick], topics)
            for k, topic in zip(robots, topics, strict=True):
                self._command[0, k] = self._twist(k, received.get(topic))
        except (ChannelError, ValueError) as error:
            self._disconnect()
            raise CallFailed(f"act: {error}") from None
        self._heading = observation.heading[0].copy()
        return self._command.copy()

    def remarks(self, row: int) -> Sequence[str]:
        if not self._missed:
            return ()
        return (f"{self._missed} commands did not come in time (missing: {self.config.missing})",)

    def _robot(self, seen: Observation, k: int) -> Iterator[messages.Message]:
        """Yield the messages about robot k."""
        at, now, dt = (0, k), self._start + float(seen.time[0]), self._briefing.dt
        position, heading = seen.position[at], float(seen.heading[at])
        turn_rate = math.remainder(heading - float(self._heading[k]), math.tau) / dt
        content = {
            "odom nav_msgs/msg/Odometry": messages.odometry(
                now, position, heading, seen.velocity[at], turn_rate
            ),
            "tf tf2_msgs/msg/TFMessage": messages.transforms(now, position, heading),
            "scan sensor_msgs/msg/LaserScan": messages.scan(
                now, seen.rays.angle, seen.rays.distance[at], seen.rays.kind[at],
                self.config.range_max, dt,
            ),
        }  # fmt: skip
        if self.config.people:
            near, count = seen.neighbours, seen.neighbours.count[at]
            arrays = (near.position, near.velocity, near.kind, near.radius)
            content["people people_msgs/msg/People"] = messages.people(
                now, *(array[at][:count] for array in arrays)
            )
        for name, message in content.items():
            topic, kind = name.split()
            yield messages.publication(f"/robot_{k}/{topic}", kind, message)

    def _twist(self, k: int, message: messages.Message | None) -> Sequence[float]:
        if message is not None:
            return messages.twist(message)
        if self.config.missing == "fail":
            raise ValueError(f"no cmd_vel of robot {k} came in time")
        self._missed += 1
        return self._command[0, k] if self.config.missing == "hold" else (0.0, 0.0)

    def _connect(self) -> Channel:
        """Return a new channel; the ROS time of its episode begins at ``_start`` [s]."""
        channel = connect(self.config.socket, self.config.timeout)
        start = channel.receive().get("start")
        if not isinstance(start, (int, float)):
            channel.close()
            raise ChannelError("the node must greet with the number 'start'")
        self._start = float(start)
        return channel

    def _disconnect(self) -> None:
        if self._channel is not None:
            self._channel.close()
        self._channel = None

    def _exchange(
        self,
        published: Iterable[messages.Message],
        topics: Mapping[str, str] = MappingProxyType({}),
    ) -> dict[str, Any]:
        """Publish messages, and return those that came on ``topics`` (topic: type)."""
        if self._channel is None:
            raise ChannelError("the connection to the node was lost")
        self._channel.send({"publish": list(published), "await": dict(topics)})
        received = self._channel.receive().get("received")
        if not isinstance(received, dict):
            raise ChannelError("the node must answer with the field 'received'")
        return received


def _require_one_world(rows: np.ndarray) -> None:
    """Raise CallFailed for several worlds: benchnav then runs each of them on its own."""
    if len(rows) > 1:
        raise CallFailed("a ROS 2 graph holds one world at a time", np.arange(len(rows)))


if __name__ == "__main__":
    sys.argv[1:] = ["navigator:Ros2Controller"]
    host.main()
