"""Queues and threads: a worker takes frames, an Event gates it, results return through a second queue."""

import queue
import threading

import rospy
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Bool, Float32, Int32


class Worker(threading.Thread):
    def __init__(self, inbox, outbox):
        super(Worker, self).__init__(daemon=True)
        self.inbox = inbox
        self.outbox = outbox
        self.go = threading.Event()
        self.threshold = 40

    def run(self):
        while not rospy.is_shutdown():
            self.go.wait()
            try:
                frame = self.inbox.get(timeout=0.5)
            except queue.Empty:
                continue
            self.outbox.put((frame.header.seq, sum(bytearray(frame.data)) / float(len(frame.data))))


class Node:
    def __init__(self):
        self.frames = queue.Queue(maxsize=2)
        self.results = queue.Queue()
        self.worker = Worker(self.frames, self.results)
        self.brightness = rospy.Publisher("brightness", Float32, queue_size=1)
        self.sequence = rospy.Publisher("sequence", Int32, queue_size=1)
        self.dark = rospy.Publisher("dark", Bool, queue_size=1)
        self.settings = rospy.Publisher("threshold", Int32, queue_size=1)
        rospy.Subscriber("image/compressed", CompressedImage, self.on_image, queue_size=1)  # source image
        rospy.Subscriber("pause", Bool, self.on_pause)  # source pause
        self.worker.start()

    def on_image(self, msg):
        if self.frames.full():
            self.frames.get_nowait()
        self.frames.put(msg)

    def on_pause(self, msg):
        self.worker.go.clear() if msg.data else self.worker.go.set()

    def spin(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            while not self.results.empty():
                number, level = self.results.get()
                self.sequence.publish(number)  # sink image
                self.brightness.publish(level)  # sink image
                self.dark.publish(level < self.worker.threshold)  # sink image
            self.settings.publish(self.worker.threshold)  # clean
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("brightness")
    Node().spin()
