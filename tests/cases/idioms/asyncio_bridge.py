"""asyncio beside rclpy: queues filled from ROS callbacks, tasks, `gather`, and an event loop in the main thread."""

import asyncio
import json
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String


class Bridge(Node):
    def __init__(self, loop):
        super().__init__("bridge")
        self.loop = loop
        self.inbox = asyncio.Queue()
        self.reply = None
        self.out = self.create_publisher(String, "out", 10)
        self.rate = self.create_publisher(Float64, "rate", 10)
        self.beat = self.create_publisher(String, "beat", 10)
        self.create_subscription(String, "in", self.on_in, 10)  # source text
        self.create_subscription(Float64, "speed", self.on_speed, 10)  # source speed

    def on_in(self, msg):
        self.loop.call_soon_threadsafe(self.inbox.put_nowait, msg.data)

    def on_speed(self, msg):
        asyncio.run_coroutine_threadsafe(self.forward(msg.data), self.loop)

    async def forward(self, speed):
        await asyncio.sleep(0.01)
        scaled = await self.scale(speed)
        self.rate.publish(Float64(data=scaled))  # sink speed

    async def scale(self, speed):
        return speed * 3.6

    async def consume(self):
        while True:
            text = await self.inbox.get()
            self.out.publish(String(data=json.dumps({"text": text})))  # sink text
            self.inbox.task_done()

    async def heartbeat(self):
        while rclpy.ok():
            self.beat.publish(String(data="beat"))  # clean
            await asyncio.sleep(1.0)

    async def run(self):
        await asyncio.gather(self.consume(), self.heartbeat())


def main():
    rclpy.init()
    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    node = Bridge(loop)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    loop.run_until_complete(node.run())


if __name__ == "__main__":
    main()
