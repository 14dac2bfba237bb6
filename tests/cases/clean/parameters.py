import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Tuned(Node):
    def __init__(self):
        super().__init__("tuned")
        self.declare_parameters(namespace="", parameters=[("gain", 0.5), ("limit", 1.0), ("topic", "in")])
        self.declare_parameter("offset", 0.1)
        self.gain = self.get_parameter("gain").value
        self.limit = self.get_parameter("limit").get_parameter_value().double_value
        self.offset = self.get_parameter("offset").value
        self.extra = self.get_parameter_or("extra", Parameter("extra", value=2.0)).value
        self.all = [p.value for p in self.get_parameters(["gain", "limit"])]
        self.add_on_set_parameters_callback(self.on_parameters)
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value

    def on_parameters(self, parameters):
        for parameter in parameters:
            if parameter.name == "gain":
                self.gain = parameter.value

    def on_in(self, msg):
        self.pub.publish(Float64(data=self.gain * msg.data + self.offset))  # sink value
        self.pub.publish(Float64(data=min(msg.data, self.limit)))  # sink value
        self.pub.publish(Float64(data=self.gain))  # clean
        self.pub.publish(Float64(data=self.limit))  # clean
        self.pub.publish(Float64(data=self.extra))  # clean
        self.pub.publish(Float64(data=self.all[0]))  # clean
        if self.gain > 1.0:
            self.pub.publish(Float64(data=self.offset))  # clean


def main():
    rclpy.init()
    rclpy.spin(Tuned())
