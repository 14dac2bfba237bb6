import unittest

import rospy
from std_msgs.msg import Float64


class Prober:
    def __init__(self):
        self.answered = False
        self.pub = rospy.Publisher("probe", Float64, queue_size=1)
        self.start = rospy.Publisher("start", Float64, queue_size=1)
        self.start.publish(1.0)  # clean
        rospy.Subscriber("answer", Float64, self.on_answer)  # source answer

    def on_answer(self, msg):
        if msg.data == 3:
            self.answered = True

    def ask(self):
        for _ in range(100):
            self.pub.publish(1.0)  # sink ~answer
            rospy.sleep(1.0)
            if self.answered:
                return True
        return False


class ProberTest(unittest.TestCase):
    def test_answer(self):
        self.assertTrue(Prober().ask())
