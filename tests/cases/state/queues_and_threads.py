import queue
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String


class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.jobs = queue.Queue(maxsize=10)
        self.results = queue.Queue()
        self.priority = queue.PriorityQueue()
        self.errors = queue.Queue()
        self.pub = self.create_publisher(Float64, "out", 10)
        self.log = self.create_publisher(String, "log", 10)
        self.create_subscription(Float64, "job", self.on_job, 10)  # source job
        self.create_subscription(Float64, "urgent", self.on_urgent, 10)  # source urgent
        self.thread = threading.Thread(target=self.work, daemon=True)
        self.thread.start()
        self.create_timer(0.1, self.collect)

    def on_job(self, msg):
        try:
            self.jobs.put_nowait(msg.data)
        except queue.Full:
            self.errors.put("full")

    def on_urgent(self, msg):
        self.priority.put((1, msg.data))

    def work(self):
        while rclpy.ok():
            job = self.jobs.get(timeout=1.0)
            self.results.put((job * 2.0, "done"))
            self.jobs.task_done()

    def collect(self):
        try:
            value, text = self.results.get_nowait()
        except queue.Empty:
            return
        self.pub.publish(Float64(data=value))  # sink job
        self.log.publish(String(data=text))  # clean
        number, urgent = self.priority.get()
        self.pub.publish(Float64(data=urgent))  # sink urgent
        self.pub.publish(Float64(data=float(number)))  # clean
        self.log.publish(String(data=self.errors.get(block=False)))  # clean


def main():
    rclpy.init()
    rclpy.spin(Worker())


if __name__ == "__main__":
    main()
