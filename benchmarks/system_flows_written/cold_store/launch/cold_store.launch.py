"""Start the climate node, the fans and the logbook of one cold store."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    """Return the three nodes, all in the namespace of the store."""
    setpoint = LaunchConfiguration("setpoint")
    return LaunchDescription(
        [
            DeclareLaunchArgument("setpoint", default_value="4.0"),
            Node(
                package="cold_store",
                executable="climate_node",
                name="climate",
                namespace="store",
                parameters=[{"margin": 1.5}],
                remappings=[("humidity", "/weather/humidity")],
            ),
            Node(
                package="cold_store",
                executable="fan_node",
                name="fan",
                namespace="store",
                parameters=[{"setpoint": setpoint}],
            ),
            Node(
                package="cold_store",
                executable="logbook_node",
                name="logbook",
                namespace="store",
                remappings=[("mode", "fan/mode")],
            ),
        ]
    )
