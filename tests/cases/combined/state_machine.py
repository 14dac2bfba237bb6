"""States as objects in a dict, chosen by a tainted condition; a queue of commands; a message kept on self."""

import enum
from collections import deque

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, String


class Mode(enum.Enum):
    WAIT = 0
    DRIVE = 1
    AVOID = 2


class State:
    speed = 0.0

    def __init__(self, machine):
        self.machine = machine

    def step(self, cmd):
        cmd.linear.x = self.speed
        return Mode.WAIT


class Drive(State):
    speed = 0.4

    def step(self, cmd):
        super().step(cmd)
        return Mode.AVOID if self.machine.nearest() < 0.5 else Mode.DRIVE


class Avoid(State):
    def step(self, cmd):
        cmd.angular.z = 1.0 / self.machine.nearest()
        return Mode.DRIVE


class Machine:
    def __init__(self):
        self.states = {Mode.WAIT: State(self), Mode.DRIVE: Drive(self), Mode.AVOID: Avoid(self)}
        self.mode = Mode.WAIT
        self.scan = None
        self.requests = deque()
        self.cmd = Twist()
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.log = rospy.Publisher("log", String, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("start", Bool, self.on_start)  # source start

    def on_scan(self, msg):
        self.scan = msg

    def on_start(self, msg):
        if msg.data:
            self.requests.append(Mode.DRIVE)

    def nearest(self):
        return min(self.scan.ranges)

    def run(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if self.requests:
                self.mode = self.requests.popleft()
            self.cmd.linear.x = self.cmd.angular.z = 0.0
            self.mode = self.states[self.mode].step(self.cmd)
            self.pub.publish(self.cmd)  # sink scan ~start
            self.log.publish("step")  # clean
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("machine")
    Machine().run()
