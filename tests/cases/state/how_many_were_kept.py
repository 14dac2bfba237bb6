"""The number of stored elements is data of a message that was stored and decided on storing; else only a decision."""

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Int32


class Obstacles:
    def __init__(self):
        self.recording = False
        self.trail = []
        self.marks = []
        self.every = []
        self.near = rospy.Publisher("near", Int32, queue_size=1)
        self.turns = rospy.Publisher("turns", Int32, queue_size=1)
        self.kept = rospy.Publisher("kept", Int32, queue_size=1)
        self.blind = rospy.Publisher("blind", Int32, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("record", Bool, self.on_record)  # source record

    def on_record(self, msg):
        self.recording = msg.data  # step ~record

    def on_scan(self, msg):
        near = []
        for place, beam in enumerate(msg.ranges):  # step scan
            if beam < 1.0:  # step ~scan
                near.append((place, beam))  # step scan
        count = len(near)  # step scan
        self.near.publish(count)  # sink scan
        if self.recording:  # step ~record
            self.trail.append(msg.range_min)
        self.kept.publish(len(self.trail))  # sink ~record
        if msg.range_max > 9.0:
            self.marks.append(1.0)
        self.blind.publish(len(self.marks))  # sink ~scan
        turns = 0
        for beam in msg.ranges:
            if beam > 3.0:
                turns += 1
        self.turns.publish(turns)  # sink ~scan
        self.every.append(msg.range_min)
        self.turns.publish(len(self.every))  # clean


rospy.init_node("obstacles")
Obstacles()
rospy.spin()
