import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Prober(Node):
    def __init__(self):
        super().__init__("prober")
        self.create_subscription(Float64, "/in", lambda message: say("in", message.data, self.now()), 10)
        self.fast = self.create_timer(0.1, lambda: say("fast", self.now()))
        self.slow = self.create_timer(0.25, self.on_slow)

    def now(self):
        return self.get_clock().now().nanoseconds

    def on_slow(self):
        say("slow", self.now(), self.fast.is_canceled(), self.fast.timer_period_ns)
        if self.fast.is_canceled():
            self.fast.reset()
        else:
            self.fast.cancel()


rclpy.init()
try:
    rclpy.spin(Prober())
except Exception as error:
    say(type(error).__name__, rclpy.ok())
