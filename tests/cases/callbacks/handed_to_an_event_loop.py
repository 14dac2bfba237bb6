import asyncio
import threading
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Pipe(Node):
    def __init__(self, loop):
        super().__init__("pipe")
        self.loop = loop
        self.queue = asyncio.Queue()
        self.out = self.create_publisher(Float32, "out", 1)
        self.beat = self.create_publisher(String, "beat", 1)
        self.create_subscription(Float32, "in", self.on_in, 10)  # source x

    def on_in(self, msg):
        self.loop.call_soon_threadsafe(self.queue.put_nowait, msg.data)

    async def consume(self):
        while rclpy.ok():
            value = await self.queue.get()
            await self.emit(value)

    async def emit(self, value):
        self.out.publish(Float32(data=value))  # sink x

    async def heartbeat(self):
        while rclpy.ok():
            self.beat.publish(String(data="alive"))  # clean
            await asyncio.sleep(1.0)


async def run():
    rclpy.init()
    node = Pipe(asyncio.get_running_loop())
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    await asyncio.gather(node.consume(), node.heartbeat())


if __name__ == "__main__":
    asyncio.run(run())
