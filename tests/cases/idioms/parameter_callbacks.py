"""Parameters: declared with defaults, changed in a callback, read in a timer; a service that sets one."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger


class Tunable(Node):
    def __init__(self):
        super().__init__("tunable")
        self.declare_parameters("", [("gain", 1.0), ("limit", 0.5), ("label", "a")])
        self.gain = self.get_parameter("gain").value
        self.error = 0.0
        self.active = True
        self.count = 0
        self.add_on_set_parameters_callback(self.on_parameters)
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.gain_pub = self.create_publisher(Float64, "gain", 10)
        self.label = self.create_publisher(String, "label", 10)
        self.create_subscription(Float64, "error", self.on_error, 10)  # source error
        self.create_service(SetBool, "activate", self.on_activate)  # source activate
        self.create_service(Trigger, "reset", self.on_reset)
        self.timer = self.create_timer(0.1, self.tick)

    def on_parameters(self, parameters):
        for parameter in parameters:
            if parameter.name == "gain" and parameter.type_ == Parameter.Type.DOUBLE:
                self.gain = parameter.value
        return SetParametersResult(successful=True)

    def on_error(self, msg):
        self.error = msg.data

    def on_activate(self, request, response):
        self.active = request.data
        response.success = True
        return response

    def on_reset(self, request, response):
        self.count = 0
        self.error = 0.0
        response.message = "reset"
        self.label.publish(String(data="reset"))  # clean
        return response

    def tick(self):
        self.count += 1
        self.gain_pub.publish(Float64(data=self.gain))  # clean
        self.label.publish(String(data=self.get_parameter("label").value))  # clean
        if not self.active:
            return
        limit = self.get_parameter("limit").get_parameter_value().double_value
        twist = Twist()
        twist.angular.z = max(-limit, min(limit, -self.gain * self.error))
        self.cmd.publish(twist)  # sink error ~activate


def main():
    rclpy.init()
    rclpy.spin(Tunable())


if __name__ == "__main__":
    main()
