import copy

import rclpy
from nav_msgs.msg import MapMetaData, OccupancyGrid, Odometry
from rclpy.node import Node
from std_msgs.msg import Header


class Blank(Node):
    def __init__(self):
        super().__init__("blank")
        self.blank = self.create_publisher(OccupancyGrid, "blank", 1)
        self.sized = self.create_publisher(OccupancyGrid, "sized", 1)
        self.still = self.create_publisher(Odometry, "still", 1)
        self.create_subscription(OccupancyGrid, "map", self.heard, 1)  # source map
        self.create_subscription(Odometry, "odom", self.moved, 1)  # source odom

    def heard(self, msg):
        blank = copy.deepcopy(msg)
        blank.header = Header(frame_id="map")
        blank.data = [-1] * 100
        self.sized.publish(blank)  # sink map
        blank.info = MapMetaData()
        self.blank.publish(blank)  # clean

    def moved(self, msg):
        msg.header = Header()
        msg.child_frame_id = "base"
        msg.pose.pose = Odometry().pose.pose
        msg.pose.covariance = [0.0] * 36
        msg.twist.covariance = [0.0] * 36
        msg.twist.twist.linear.x = 0.0
        self.still.publish(msg)  # sink odom
        msg.twist.twist = Odometry().twist.twist
        self.still.publish(msg)  # clean


rclpy.init()
rclpy.spin(Blank())
