"""Start the drive, the lift and the mission node of one shuttle."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    """Return the three nodes; the emergency stop is one topic for the whole hall."""
    hall = [("estop", "/hall/estop")]
    return LaunchDescription(
        [
            Node(
                package="pallet_shuttle",
                executable="drive_node",
                name="drive",
                remappings=[*hall, ("target", "mission/target")],
                parameters=[{"max_speed": 1.2}],
            ),
            Node(package="pallet_shuttle", executable="lift_node", name="lift", remappings=hall),
            Node(package="pallet_shuttle", executable="mission_node", name="mission"),
        ]
    )
