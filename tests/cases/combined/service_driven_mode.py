import rclpy
from rclpy.node import Node
from rclpy.callback_groups import ReentrantCallbackGroup, MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from rcl_interfaces.msg import SetParametersResult
from std_srvs.srv import SetBool, Trigger
from geometry_msgs.msg import TwistStamped, Twist
from std_msgs.msg import Float32


class Switch(Node):
    def __init__(self):
        super().__init__("switch")
        self.declare_parameter("max_speed", 1.0)
        self.max_speed = self.get_parameter("max_speed").value
        self.add_on_set_parameters_callback(self.on_params)
        self.auto = False
        self.latest = None
        group = ReentrantCallbackGroup()
        self.sub = self.create_subscription(  # source teleop
            Twist, "teleop", self.on_teleop, qos_profile_sensor_data, callback_group=group)
        self.sub2 = self.create_subscription(msg_type=Twist, topic="auto", callback=self.on_auto, qos_profile=10)  # source auto
        self.srv = self.create_service(SetBool, "set_auto", self.set_auto, callback_group=MutuallyExclusiveCallbackGroup())  # source setauto
        self.trigger = self.create_service(Trigger, "last", self.on_last)
        self.pub = self.create_publisher(TwistStamped, "cmd", QoSProfile(depth=1))
        self.speed_pub = self.create_publisher(Float32, "max_speed", 1)

    def on_params(self, params):
        for p in params:
            if p.name == "max_speed":
                self.max_speed = p.value
        return SetParametersResult(successful=True)

    def set_auto(self, request, response):
        self.auto = request.data
        response.success = True
        response.message = "auto" if self.auto else "manual"
        return response  # sink ~setauto

    def on_last(self, _, response):
        response.success = self.latest is not None
        return response  # clean

    def limit(self, v):
        return max(-self.max_speed, min(self.max_speed, v))

    def send(self, twist):
        out = TwistStamped()
        out.header.stamp = self.get_clock().now().to_msg()
        out.twist = twist
        out.twist.linear.x = self.limit(twist.linear.x)
        self.pub.publish(out)  # sink teleop auto ~setauto
        self.speed_pub.publish(Float32(data=self.max_speed))  # sink ~setauto

    def on_teleop(self, msg):
        self.latest = msg
        if not self.auto:
            self.send(msg)

    def on_auto(self, msg):
        if self.auto:
            self.send(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Switch()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
