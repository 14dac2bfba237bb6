import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


class Talker(Node):
    def __init__(self, shared):
        super().__init__("talker")
        self.shared = shared
        self.timer_period = 0.5
        self.pub = self.create_publisher(Float64, "out", QoSProfile(depth=1))
        self.timer = self.create_timer(self.timer_period, self.tick, callback_group=MutuallyExclusiveCallbackGroup())

    def tick(self):
        self.pub.publish(Float64(data=self.shared["value"]))  # sink value
        self.pub.publish(Float64(data=self.timer_period))  # clean


class Listener(Node):
    def __init__(self, shared):
        super().__init__("listener")
        self.shared = shared
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.sub = self.create_subscription(  # source value
            msg_type=Float64,
            topic="in",
            callback=self.listen,
            qos_profile=qos,
        )

    def listen(self, msg):
        self.shared["value"] = msg.data


def main(args=None):
    rclpy.init(args=args)
    shared = {"value": 0.0}
    executor = MultiThreadedExecutor(num_threads=2)
    nodes = [Talker(shared), Listener(shared)]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
