"""A node without ROS that speaks the messages of `channel.py`: it steers by scan, odom and goal.

    python stub_node.py SOCKET [--speed 1.0] [--turn-rate 2.0] [--near 1.5]

Equal messages give equal commands, so a run with it can be repeated bit for bit.
"""

import argparse
import math
from typing import Any

from channel import Channel, serve

Message = dict[str, Any]
SIDE = 0.35  # [rad] a direction must be free so far to both sides
TURNING = 0.3  # cost of turning away from the heading, per radian


def steer(odometry: Message, scan: Message, goal: Message, options: argparse.Namespace) -> Message:
    """Return a geometry_msgs/Twist: to the free direction that is nearest to the goal."""
    pose = odometry["pose"]["pose"]
    yaw = 2 * math.atan2(pose["orientation"]["z"], pose["orientation"]["w"])
    x, y = (goal["position"][axis] - pose["position"][axis] for axis in "xy")
    far, towards = math.hypot(x, y), math.atan2(y, x) - yaw
    ways = []
    for k in range(len(scan["ranges"])):
        angle = scan["angle_min"] + k * scan["angle_increment"]
        reach = round(SIDE / scan["angle_increment"]) if scan["angle_increment"] else 0
        clear = min(scan["ranges"][max(k - reach, 0) : k + reach + 1])
        away = abs(math.remainder(angle - towards, math.tau)) + TURNING * abs(angle)
        blocked = clear < min(options.near, far)
        ways.append((blocked, -clear if blocked else away, angle, clear))
    blocked, _, angle, clear = min(ways)
    if not blocked and abs(math.remainder(angle - towards, math.tau)) < SIDE:
        angle = math.remainder(towards, math.tau)  # the goal lies between two rays
    pace = options.speed * min(1.0, clear / options.near, far / 0.5) * max(0.0, math.cos(angle))
    rate = max(-options.turn_rate, min(options.turn_rate, 3.0 * angle))
    return {"linear": {"x": pace, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": rate}}


def main() -> None:
    """Serve until the process is stopped."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("socket", help="path of the socket")
    parser.add_argument("--speed", type=float, default=1.0, help="[m/s] default: 1.0")
    parser.add_argument("--turn-rate", type=float, default=2.0, help="[rad/s] default: 2.0")
    parser.add_argument("--near", type=float, default=1.5, help="[m] clear distance, default: 1.5")
    options = parser.parse_args()

    def drive(channel: Channel) -> None:
        channel.send({"start": 0.0})
        latest = {}
        while True:
            request = channel.receive()
            latest.update((each["topic"], each["message"]) for each in request["publish"])
            received = {}
            for topic, kind in request["await"].items():
                robot = topic.removesuffix("/cmd_vel")
                topics = (f"{robot}/{name}" for name in ("odom", "scan", "goal_pose"))
                odometry, scan, goal = (latest[topic] for topic in topics)
                twist = steer(odometry, scan, goal["pose"], options)
                stamp = odometry["header"]["stamp"]
                header = {"stamp": stamp, "frame_id": "base_link"}
                stamped = kind.endswith("/TwistStamped")
                received[topic] = {"header": header, "twist": twist} if stamped else twist
            channel.send({"received": received})

    serve(options.socket, drive)


if __name__ == "__main__":
    main()
