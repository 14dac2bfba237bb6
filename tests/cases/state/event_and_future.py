import asyncio
import concurrent.futures
import threading

import rclpy
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Float64


class Waiter(Node):
    def __init__(self):
        super().__init__("waiter")
        self.arrived = threading.Event()
        self.payload = None
        self.future = Future()
        self.other = Future()
        self.pool = concurrent.futures.ThreadPoolExecutor()
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "once", self.on_once, 10)  # source once
        self.create_subscription(Float64, "job", self.on_job, 10)  # source job

    def on_once(self, msg):
        self.payload = msg.data
        self.arrived.set()
        self.future.set_result(msg)
        self.other.set_result(4.0)

    def on_job(self, msg):
        job = self.pool.submit(self.compute, msg.data, 2.0)
        job.add_done_callback(self.on_done)
        still = self.pool.submit(self.compute, 1.0, 2.0)
        self.pub.publish(Float64(data=still.result()))  # clean

    def compute(self, value, factor):
        return value * factor

    def on_done(self, job):
        self.pub.publish(Float64(data=job.result()))  # sink job


def main():
    rclpy.init()
    node = Waiter()
    rclpy.spin_until_future_complete(node, node.future)
    node.pub.publish(node.future.result())  # sink once
    node.pub.publish(Float64(data=node.other.result()))  # clean
    node.arrived.wait()
    node.pub.publish(Float64(data=node.payload))  # sink once
    if node.arrived.is_set():
        node.pub.publish(Float64(data=1.0))  # clean
    rclpy.spin(node)


if __name__ == "__main__":
    main()
