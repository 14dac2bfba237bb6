"""Ask the patrol server for one square."""

import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from turtlebot3_msgs.action import Patrol


def main():
    """Send the goal: a square (1) with sides of 0.8 m, once."""
    rclpy.init()
    node = Node("ask")
    client = ActionClient(node, Patrol, "turtlebot3")
    client.wait_for_server()
    goal = Patrol.Goal()
    goal.goal.x, goal.goal.y, goal.goal.z = 1.0, 0.8, 1.0
    client.send_goal_async(goal)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
