"""Context managers around work: a class with `__enter__`, a generator, `suppress`, and `ExitStack`."""

import contextlib
import time

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, String


class Stopwatch:
    def __init__(self, publisher):
        self.publisher = publisher
        self.seen = 0.0

    def __enter__(self):
        self.started = time.time()
        return self

    def __exit__(self, kind, error, trace):
        self.publisher.publish(time.time() - self.started)  # clean
        return False


class Collected:
    def __init__(self, publisher):
        self.publisher = publisher
        self.values = []

    def __enter__(self):
        return self.values

    def __exit__(self, *_):
        self.publisher.publish(max(self.values))  # sink scan


class Front:
    def __init__(self):
        self.time_pub = rospy.Publisher("time", Float32, queue_size=1)
        self.max_pub = rospy.Publisher("max", Float32, queue_size=1)
        self.min_pub = rospy.Publisher("min", Float32, queue_size=1)
        self.phase_pub = rospy.Publisher("phase", String, queue_size=1)
        self.closest = float("inf")
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan

    @contextlib.contextmanager
    def phase(self, name):
        self.phase_pub.publish(name + " begins")  # clean
        try:
            yield self.closest
        finally:
            self.phase_pub.publish(name + " ends")  # clean

    def on_scan(self, msg):
        with Stopwatch(self.time_pub), Collected(self.max_pub) as values:
            values.extend(r for r in msg.ranges if r < msg.range_max)
        with self.phase("minimum") as before:
            self.min_pub.publish(before)  # sink scan
            self.closest = min(msg.ranges)
        with contextlib.suppress(IndexError):
            self.min_pub.publish(msg.ranges[360])  # sink scan
        with contextlib.ExitStack() as stack:
            stack.callback(self.done)
            stack.enter_context(Stopwatch(self.time_pub))

    def done(self):
        self.phase_pub.publish("done")  # clean


if __name__ == "__main__":
    rospy.init_node("front")
    Front()
    rospy.spin()
