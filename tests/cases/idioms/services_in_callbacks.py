"""Services called in callbacks, whose responses depend on the requests: futures with `add_done_callback`, `await`, a server that keeps its request."""

import rclpy
from example_interfaces.srv import AddTwoInts, SetBool
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import Bool, Int64, String


class Caller(Node):
    def __init__(self):
        super().__init__("caller")
        group = ReentrantCallbackGroup()
        self.total = 0
        self.enabled = True
        self.client = self.create_client(AddTwoInts, "add", callback_group=group)
        self.sum = self.create_publisher(Int64, "sum", 10)
        self.running = self.create_publisher(Int64, "running", 10)
        self.text = self.create_publisher(String, "text", 10)
        self.flag = self.create_publisher(Bool, "flag", 10)
        self.create_subscription(Int64, "a", self.on_a, 10, callback_group=group)  # source a
        self.create_subscription(Int64, "b", self.on_b, 10, callback_group=group)  # source b
        self.create_service(SetBool, "enable", self.on_enable)  # source enable
        self.text.publish(String(data="ready"))  # clean

    def on_a(self, msg):
        request = AddTwoInts.Request(a=msg.data, b=1)
        future = self.client.call_async(request)
        future.add_done_callback(self.on_sum)

    def on_sum(self, future):
        if future.exception() is not None:
            self.text.publish(String(data="failed"))
            return
        self.total += future.result().sum
        self.sum.publish(Int64(data=future.result().sum))  # sink a

    async def on_b(self, msg):
        if not self.enabled:
            return
        response = await self.client.call_async(AddTwoInts.Request(a=msg.data, b=self.total))
        self.running.publish(Int64(data=response.sum))  # sink a b ~enable
        self.flag.publish(Bool(data=True))  # sink ~enable

    def on_enable(self, request, response):
        self.enabled = request.data
        response.success = True
        response.message = "on" if request.data else "off"
        self.flag.publish(Bool(data=request.data))  # sink enable
        return response  # sink ~enable


def main():
    rclpy.init()
    rclpy.spin(Caller())


if __name__ == "__main__":
    main()
