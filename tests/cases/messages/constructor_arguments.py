import rclpy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, Vector3
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import ColorRGBA, Float64, Header


class Build(Node):
    def __init__(self):
        super().__init__("build")
        self.pub = self.create_publisher(PoseStamped, "pose", 10)
        self.twist = self.create_publisher(Twist, "cmd_vel", 10)
        self.number = self.create_publisher(Float64, "number", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom

    def on_odom(self, msg):
        x, y = msg.pose.pose.position.x, 2.0
        header = Header(frame_id="map")
        pose = PoseStamped(header=header, pose=Pose(position=Point(x=x, y=y, z=0.0)))
        self.pub.publish(pose)  # sink odom
        self.number.publish(Float64(data=pose.pose.position.x))  # sink odom
        self.number.publish(Float64(data=pose.pose.position.y))  # clean
        self.pub.publish(PoseStamped(header=header, pose=Pose(orientation=Quaternion(w=1.0))))  # clean
        self.twist.publish(Twist(linear=Vector3(x=msg.twist.twist.linear.x)))  # sink odom
        self.twist.publish(Twist(Vector3(x, 0.0, 0.0), Vector3()))  # sink odom
        self.twist.publish(Twist(Vector3(y, 0.0, 0.0), Vector3()))  # clean
        point = Point(x, y, 0.0)
        self.number.publish(Float64(data=point.x))  # sink odom
        color = ColorRGBA(r=1.0)
        color.g = msg.pose.pose.position.y
        self.number.publish(Float64(data=color.g))  # sink odom
        self.number.publish(Float64(data=color.r))  # clean


def main():
    rclpy.init()
    rclpy.spin(Build())
