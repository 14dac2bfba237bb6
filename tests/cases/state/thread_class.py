import threading
import time

import rospy
from std_msgs.msg import Float64


class Loop(threading.Thread):
    def __init__(self, pub):
        super().__init__()
        self.pub = pub
        self.target = 0.0
        self.gain = 0.3
        self.lock = threading.Lock()

    def set_target(self, value):
        with self.lock:
            self.target = value

    def run(self):
        while not rospy.is_shutdown():
            with self.lock:
                target = self.target
            self.pub.publish(self.gain * target)  # sink target
            self.pub.publish(self.gain)  # clean
            time.sleep(0.01)


def main():
    rospy.init_node("loop")
    loop = Loop(rospy.Publisher("out", Float64, queue_size=1))
    rospy.Subscriber("target", Float64, lambda msg: loop.set_target(msg.data))  # source target
    loop.start()
    rospy.spin()
    loop.join()


if __name__ == "__main__":
    main()
