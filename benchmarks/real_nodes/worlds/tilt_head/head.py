"""The head of the robot: looks where it is told, which takes half a second."""

import actionlib
import rospy
from control_msgs.msg import PointHeadAction
from geometry_msgs.msg import Point


class Head:
    """The action server of the head; it publishes the point at which the head looks."""

    def __init__(self):
        self.looks = rospy.Publisher("/looks", Point, queue_size=1)
        self.server = actionlib.SimpleActionServer(
            "head_controller/point_head", PointHeadAction, self.point, False
        )
        self.server.start()

    def point(self, goal):
        """Turn to a point."""
        rospy.sleep(0.5)
        self.looks.publish(goal.target.point)
        self.server.set_succeeded()


if __name__ == "__main__":
    rospy.init_node("head")
    Head()
    rospy.spin()
