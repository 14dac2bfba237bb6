from typing import Optional
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn, State, Publisher as LP
from rclpy.timer import Timer
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
import message_filters
from message_filters import Subscriber, ApproximateTimeSynchronizer
from sensor_msgs.msg import Image, CameraInfo, PointCloud2, Imu
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import String, Float32


class Detector(LifecycleNode):
    def __init__(self, name, **kwargs):
        super().__init__(name, **kwargs)
        self._pub: Optional[LP] = None
        self._timer: Optional[Timer] = None
        self._last = None
        self._depth = None

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        self._pub = self.create_lifecycle_publisher(PoseStamped, "detection", 10)
        self._dbg = self.create_publisher(String, "debug", 10)
        self._rgb = Subscriber(self, Image, "rgb", qos_profile=qos_profile_sensor_data)  # source rgb
        self._dep = Subscriber(self, Image, "depth")  # source depth
        self._info = Subscriber(self, CameraInfo, "info")  # source info
        self._sync = ApproximateTimeSynchronizer([self._rgb, self._dep, self._info], 10, 0.1)
        self._sync.registerCallback(self._on_frames)
        self._imu = self.create_subscription(Imu, "imu", self._on_imu, 10)  # source imu
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self._timer = self.create_timer(0.1, self._publish)
        return super().on_activate(state)

    def on_cleanup(self, state):
        self._last = None
        self.destroy_publisher(self._pub)
        return TransitionCallbackReturn.SUCCESS

    def _on_imu(self, imu):
        self._tilt = imu.orientation.x

    def _on_frames(self, rgb, depth, info):
        p = PoseStamped()
        p.header = depth.header
        p.pose.position.x = (rgb.width / 2 - info.k[2]) / info.k[0]
        p.pose.position.z = float(depth.data[0])
        self._last = p

    def _publish(self):
        self._dbg.publish(String(data="timer"))  # clean
        if self._pub is None or not self._pub.is_activated:
            return
        if self._last is not None:
            self._last.pose.orientation.x = self._tilt
            self._pub.publish(self._last)  # sink rgb depth info imu
            self._dbg.publish(String(data=self._last.header.frame_id))  # sink depth
            self._dbg.publish(String(data="%.2f" % self._last.pose.position.z))  # sink depth
            self._dbg.publish(String(data=str(self._last.pose.position.x)))  # sink rgb info


def main():
    rclpy.init()
    node = Detector("detector")
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
