"""Launch the bridge: ``ros2 launch ./bridge.launch.py socket:=/tmp/benchnav.sock``.

Untried, like `bridge_node.py`. Add your controller: one node per robot, in the namespace /robot_k.
"""

import sys
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

BRIDGE = Path(__file__).resolve().with_name("bridge_node.py")
ARGUMENTS = {
    "socket": ("/tmp/benchnav.sock", "path of the socket"),  # noqa: S108
    "command_timeout": ("2.0", "[s] to wait for cmd_vel in a decision"),
}


def generate_launch_description() -> LaunchDescription:
    """Return the description that `ros2 launch` reads."""
    arguments = [
        DeclareLaunchArgument(name, default_value=value, description=text)
        for name, (value, text) in ARGUMENTS.items()
    ]
    command = [sys.executable, str(BRIDGE), "--ros-args"]
    for name in ARGUMENTS:
        command += ["-p", [f"{name}:=", LaunchConfiguration(name)]]
    return LaunchDescription([*arguments, ExecuteProcess(cmd=command, output="screen")])
