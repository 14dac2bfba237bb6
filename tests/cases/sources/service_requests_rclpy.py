import rclpy
from example_interfaces.srv import AddTwoInts, SetBool
from rclpy.node import Node
from std_msgs.msg import Float64


class Adder(Node):
    def __init__(self):
        super().__init__("adder")
        self.offset = 0.0
        self.pub = self.create_publisher(Float64, "sum", 10)
        self.create_subscription(Float64, "offset", self.on_offset, 10)  # source offset
        self.srv = self.create_service(AddTwoInts, "add", self.on_add)  # source add
        self.create_service(SetBool, "on", self.on_switch)  # source switch

    def on_offset(self, msg):
        self.offset = msg.data

    def on_add(self, request, response):
        response.sum = int(request.a + request.b + self.offset)
        self.pub.publish(Float64(data=float(request.a)))  # sink add
        return response  # sink add offset

    def on_switch(self, request, response):
        response.success = True
        if request.data:
            self.pub.publish(Float64(data=1.0))  # sink ~switch
        return response  # clean


def main():
    rclpy.init()
    rclpy.spin(Adder())
