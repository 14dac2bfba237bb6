import asyncio

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Async(Node):
    def __init__(self):
        super().__init__("coroutine")
        self.value = 0.0
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value
        self.create_subscription(Float64, "later", self.on_later, 10)  # source later
        self.create_timer(1.0, self.tick)

    async def on_in(self, msg):
        smoothed = await self.smooth(msg.data)
        self.pub.publish(Float64(data=smoothed))  # sink value
        constant = await self.smooth(1.0)
        self.pub.publish(Float64(data=constant))  # clean

    async def smooth(self, value):
        await asyncio.sleep(0.1)
        return 0.5 * value

    async def on_later(self, msg):
        asyncio.create_task(self.remember(msg.data))

    async def remember(self, value):
        self.value = value

    async def tick(self):
        self.pub.publish(Float64(data=self.value))  # sink later


def main():
    rclpy.init()
    rclpy.spin(Async())
