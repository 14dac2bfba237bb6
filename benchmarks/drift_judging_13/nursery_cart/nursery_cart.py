#!/usr/bin/env python3
"""Carry potted trees along the rows of a nursery and stop at each bed."""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, Float32MultiArray, Int16


class NurseryCart(Node):
    def __init__(self):
        super().__init__("nursery_cart")
        self.declare_parameter("max_speed", 0.9)
        self.declare_parameter("min_speed", 0.04)
        self.declare_parameter("kp", 0.8)
        self.declare_parameter("kp_lateral", 0.9)
        self.declare_parameter("kp_heading", 1.4)
        self.declare_parameter("tolerance", 0.06)
        self.declare_parameter("unload_time", 2.0)

        self.x = None
        self.y = 0.0
        self.yaw = 0.0
        self.beds = []
        self.next_bed = 0
        self.unloading_since = None
        self.person = False

        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.cmd_pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.bed_pub = self.create_publisher(Int16, "unload", 10)
        self.create_subscription(Odometry, "odom", self.odom_callback, qos)
        self.create_subscription(Float32MultiArray, "beds", self.beds_callback, 10)
        self.create_subscription(Bool, "bumper/person", self.person_callback, 10)
        self.timer = self.create_timer(0.1, self.control_loop)

    def p(self, name):
        return self.get_parameter(name).get_parameter_value().double_value

    def odom_callback(self, msg):
        self.x = msg.pose.pose.position.x
        self.y = msg.pose.pose.position.y
        # valid for small angles; the cart drives on a lane
        self.yaw = 2.0 * msg.pose.pose.orientation.z

    def beds_callback(self, msg):
        if list(msg.data) != self.beds:
            self.beds = list(msg.data)
            self.next_bed = 0
            self.get_logger().info("%d beds" % len(self.beds))

    def person_callback(self, msg):
        self.person = msg.data

    def speed_to(self, error):
        speed = self.p("kp") * error
        if speed > self.p("max_speed"):
            speed = self.p("max_speed")
        elif speed < self.p("min_speed"):
            speed = self.p("min_speed")
        return speed

    def steer(self):
        return -self.p("kp_lateral") * self.y - self.p("kp_heading") * self.yaw

    def control_loop(self):
        twist = Twist()
        if self.x is None or self.person or self.next_bed >= len(self.beds):
            self.cmd_pub.publish(twist)
            return
        now = self.get_clock().now().nanoseconds * 1e-9
        error = self.beds[self.next_bed] - self.x
        if self.unloading_since is not None:
            if now - self.unloading_since > self.p("unload_time"):
                self.unloading_since = None
                self.next_bed += 1
        elif error < self.p("tolerance"):
            self.unloading_since = now
            self.bed_pub.publish(Int16(data=self.next_bed))
        else:
            twist.linear.x = self.speed_to(error)
            twist.angular.z = self.steer()
        self.cmd_pub.publish(twist)


def main(args=None):
    rclpy.init(args=args)
    node = NurseryCart()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
