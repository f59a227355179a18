"""Launch the bridge, and for each robot Nav2's controller server with a straight path.

ros2 launch ./bridge.launch.py socket:=/tmp/benchnav.sock robots:=2

Untried, like `bridge_node.py`. `nav2:=false` launches the bridge alone, for nodes of your own.
"""

import sys
from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from nav2_common.launch import ReplaceString

HERE = Path(__file__).resolve().parent
TF = [("/tf", "tf"), ("/tf_static", "tf_static")]  # each robot has its own tree of frames
ARGUMENTS = {
    "socket": ("/tmp/benchnav.sock", "path of the socket"),  # noqa: S108
    "command_timeout": ("2.0", "[s] to wait for cmd_vel in a decision"),
    "robots": ("1", "number of robots"),
    "nav2": ("true", "whether to launch Nav2's controller server for each robot"),
    "params": (str(HERE / "nav2_params.yaml"), "parameters of Nav2"),
}


def generate_launch_description() -> LaunchDescription:
    """Return the description that `ros2 launch` reads."""
    arguments = [
        DeclareLaunchArgument(name, default_value=value, description=text)
        for name, (value, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=_actions)])


def _actions(context: LaunchContext) -> list:
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    settings = (f"socket:={given['socket']}", f"command_timeout:={float(given['command_timeout'])}")
    options = [word for setting in settings for word in ("-p", setting)]
    actions = [_script("bridge_node.py", *options)]
    if given["nav2"] == "true":
        for k in range(int(given["robots"])):
            actions += _nav2(f"robot_{k}", given["params"])
    return actions


def _nav2(robot: str, params: str) -> list:
    common = {"namespace": robot, "output": "screen"}
    own = ReplaceString(source_file=params, replacements={"<robot_namespace>": f"/{robot}"})
    managed = {"use_sim_time": True, "autostart": True, "node_names": ["controller_server"]}
    return [
        Node(
            package="nav2_controller", executable="controller_server", remappings=TF,
            parameters=[own, {"use_sim_time": True}], **common,
        ),
        Node(
            package="nav2_lifecycle_manager", executable="lifecycle_manager",
            name="lifecycle_manager", parameters=[managed], **common,
        ),
        _script("path_client.py", "-r", f"__ns:=/{robot}"),
    ]  # fmt: skip


def _script(name: str, *options: str) -> ExecuteProcess:
    command = [sys.executable, str(HERE / name), "--ros-args", *options]
    return ExecuteProcess(cmd=command, output="screen")
