"""tf2: a buffer, `do_transform_pose`, look-ups under `try`, a broadcaster, a stamp from the message."""

import rclpy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Float64, String
from tf2_ros import Buffer, TransformBroadcaster, TransformListener


class Mapper(Node):
    def __init__(self):
        super().__init__("mapper")
        self.buffer = Buffer(cache_time=Duration(seconds=10))
        self.listener = TransformListener(self.buffer, self)
        self.broadcaster = TransformBroadcaster(self)
        self.target = self.declare_parameter("target", "map").get_parameter_value().string_value
        self.out = self.create_publisher(PoseStamped, "pose_in_map", 10)
        self.point = self.create_publisher(PointStamped, "point_in_map", 10)
        self.height = self.create_publisher(Float64, "height", 10)
        self.status = self.create_publisher(String, "status", 10)
        self.create_subscription(PoseStamped, "pose", self.on_pose, 10)  # source pose
        self.create_subscription(PointStamped, "clicked", self.on_point, 10)  # source point
        self.create_timer(1.0, self.on_timer)

    def on_pose(self, msg):
        try:
            transform = self.buffer.lookup_transform(self.target, msg.header.frame_id, rclpy.time.Time())
        except (tf2_ros.LookupException, tf2_ros.ExtrapolationException) as error:
            self.status.publish(String(data=f"no transform: {error}"))  # sink pose
            return
        moved = PoseStamped()
        moved.header.frame_id = self.target
        moved.pose = tf2_geometry_msgs.do_transform_pose(msg.pose, transform)
        self.out.publish(moved)  # sink pose
        t = TransformStamped()
        t.header = msg.header
        t.child_frame_id = "object"
        t.transform.translation.x = msg.pose.position.x
        self.broadcaster.sendTransform(t)

    def on_point(self, msg):
        try:
            self.point.publish(self.buffer.transform(msg, self.target))  # sink point
        except tf2_ros.TransformException:
            self.status.publish(String(data="point lost"))  # sink ~point

    def on_timer(self):
        if self.buffer.can_transform(self.target, "base_link", rclpy.time.Time()):
            t = self.buffer.lookup_transform(self.target, "base_link", rclpy.time.Time())
            self.height.publish(Float64(data=t.transform.translation.z))  # clean


def main():
    rclpy.init()
    rclpy.spin(Mapper())


if __name__ == "__main__":
    main()
