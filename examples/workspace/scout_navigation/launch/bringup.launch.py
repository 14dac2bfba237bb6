"""Start the robot: perception, planner, and the gate in front of the wheels."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node, PushRosNamespace
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Return what is started, within the namespace of the robot."""
    perception = PathJoinSubstitution(
        [FindPackageShare("scout_perception"), "launch", "perception.launch.xml"]
    )
    limits = PathJoinSubstitution([FindPackageShare("scout_navigation"), "config", "gate.yaml"])
    robot = GroupAction(
        [
            PushRosNamespace(LaunchConfiguration("robot")),
            IncludeLaunchDescription(
                AnyLaunchDescriptionSource(perception), launch_arguments={"laser": "rear"}.items()
            ),
            Node(
                package="scout_navigation",
                executable="planner",
                remappings=[("cmd_vel", "cmd_vel_raw")],
            ),
            Node(package="scout_navigation", executable="gate", parameters=[limits]),
        ]
    )
    return LaunchDescription([DeclareLaunchArgument("robot", default_value="scout"), robot])
