"""A ROS 2 node that asks Nav2's controller server to follow the straight line to each goal.

Untried, like `bridge_node.py`. With it, Nav2 drives by its local planner alone, without a map.
"""

import math

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Point, PoseStamped
from nav2_msgs.action import FollowPath
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

SPACING = 0.1  # [m] between the poses of a path
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class PathClient(Node):
    """Sends each goal once, and again if the controller gives up."""

    def __init__(self) -> None:
        super().__init__("path_client")
        self._client = ActionClient(self, FollowPath, "follow_path")
        self._goal = self._unsent = None
        self.create_subscription(PoseStamped, "goal_pose", self._on_goal, LATCHED)
        self.create_subscription(Odometry, "odom", self._on_odometry, 10)

    def _on_goal(self, goal: PoseStamped) -> None:
        self._goal = self._unsent = goal

    def _on_odometry(self, odometry: Odometry) -> None:
        if self._unsent is None or not self._client.server_is_ready():
            return
        goal, self._unsent = self._unsent, None
        request = FollowPath.Goal()  # without ids, the server uses its only plugins
        request.path.header.frame_id = goal.header.frame_id
        request.path.header.stamp = odometry.header.stamp
        request.path.poses = straight(odometry.pose.pose.position, goal)
        sent = self._client.send_goal_async(request)
        sent.add_done_callback(lambda answer: self._on_answer(answer.result(), goal))

    def _on_answer(self, handle: ClientGoalHandle, goal: PoseStamped) -> None:
        if handle.accepted:
            finished = handle.get_result_async()
            finished.add_done_callback(lambda done: self._on_end(done.result().status, goal))
        else:
            self._on_end(GoalStatus.STATUS_ABORTED, goal)

    def _on_end(self, status: int, goal: PoseStamped) -> None:
        if status == GoalStatus.STATUS_ABORTED and goal is self._goal:
            self._unsent = goal


def straight(start: Point, goal: PoseStamped) -> list:
    """Return the poses on the line from the point ``start`` to ``goal``."""
    end = goal.pose.position
    x, y = end.x - start.x, end.y - start.y
    count = max(1, math.ceil(math.hypot(x, y) / SPACING))
    yaw = math.atan2(y, x)
    poses = []
    for k in range(count + 1):
        pose = PoseStamped()
        pose.header.frame_id = goal.header.frame_id
        pose.pose.position.x = start.x + x * k / count
        pose.pose.position.y = start.y + y * k / count
        pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        poses.append(pose)
    return poses


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(PathClient())
