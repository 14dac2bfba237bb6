import asyncio

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_msgs.msg import Float64


class Async(Node):
    def __init__(self):
        super().__init__("async_node")
        self.client = self.create_client(AddTwoInts, "add")
        self.queue = asyncio.Queue()
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value

    async def on_in(self, msg):
        first, second = await asyncio.gather(self.scaled(msg.data), self.scaled(1.0))
        self.pub.publish(Float64(data=first))  # sink value
        self.pub.publish(Float64(data=second))  # clean
        await self.queue.put(msg.data)
        request = AddTwoInts.Request()
        request.a = int(msg.data)
        response = await self.client.call_async(request)
        self.pub.publish(Float64(data=float(response.sum)))  # sink value
        async for value in self.values(msg.data):
            self.pub.publish(Float64(data=value))  # sink value
        future = self.client.call_async(AddTwoInts.Request(a=1))
        future.add_done_callback(self.on_done)
        future = self.client.call_async(AddTwoInts.Request(a=int(msg.data)))
        future.add_done_callback(self.on_sum)

    async def scaled(self, value):
        return 2.0 * value

    async def values(self, start):
        for i in range(3):
            yield start + i

    def on_done(self, future):
        self.pub.publish(Float64(data=float(future.result().sum)))  # clean

    def on_sum(self, future):
        self.pub.publish(Float64(data=float(future.result().sum)))  # sink value

    async def worker(self):
        while True:
            value = await self.queue.get()
            self.pub.publish(Float64(data=value))  # sink value


async def run():
    node = Async()
    asyncio.create_task(node.worker())
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.01)


def main():
    rclpy.init()
    asyncio.run(run())


if __name__ == "__main__":
    main()
