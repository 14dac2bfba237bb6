"""A lifecycle node: publishers and timers made in transitions, state dropped on deactivation."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, String


class Guard(LifecycleNode):
    def __init__(self, name="guard", **kwargs):
        super().__init__(name, **kwargs)
        self._pub = None
        self._timer = None
        self._scan = None
        self._sub = None
        self._margin = 0.5

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._pub = self.create_lifecycle_publisher(Twist, "cmd_vel", 10)
        self._status = self.create_publisher(String, "status", 10)
        self._echo = self.create_publisher(Float64, "margin_echo", 10)
        self._sub = self.create_subscription(LaserScan, "scan", self._on_scan, 10)  # source scan
        self.create_subscription(Float64, "margin", self._on_margin, 10)  # source margin
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._timer = self.create_timer(0.1, self._tick)
        self._status.publish(String(data="active"))  # clean
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._timer.cancel()
        self._pub.publish(Twist())  # clean
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self.destroy_subscription(self._sub)
        self._scan = None
        return TransitionCallbackReturn.SUCCESS

    def _on_scan(self, msg):
        self._scan = msg

    def _on_margin(self, msg):
        self._margin = msg.data

    def _tick(self):
        self._echo.publish(Float64(data=self._margin))  # sink margin
        if self._scan is None or not self._pub.is_activated:
            return
        twist = Twist()
        nearest = min(r for r in self._scan.ranges if r > self._scan.range_min)
        if nearest > self._margin:
            twist.linear.x = min(0.4, nearest - 0.1)
        self._pub.publish(twist)  # sink scan ~margin


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(Guard())
    executor.spin()


if __name__ == "__main__":
    main()
