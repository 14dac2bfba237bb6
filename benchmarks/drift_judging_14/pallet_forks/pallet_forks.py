#!/usr/bin/env python
"""Drive the forks of a truck into the pockets of a pallet.

The pallet is detected in the frame of the safety laser, which sits at the front left corner of the truck and looks
outwards. The truck is led along the axis of the pallet.
"""

import math

import rospy
from geometry_msgs.msg import Pose2D, Twist
from std_msgs.msg import Bool, String

# laser on the chassis
LASER_X = 0.35  # m
LASER_Y = 0.42  # m
LASER_YAW = 0.785  # rad

FORK_LENGTH = 1.15  # m
INSERTED = 0.25  # distance from the axle to the front of the pallet (m)


class PID(object):
    def __init__(self, kp, ki, kd, limit):
        self.kp, self.ki, self.kd = kp, ki, kd
        self.limit = limit
        self.integral = 0.0
        self.last = None

    def update(self, error, dt):
        self.integral += error * dt
        derivative = 0.0 if self.last is None else (error - self.last) / dt
        self.last = error
        out = self.kp * error + self.ki * self.integral + self.kd * derivative
        return max(-self.limit, min(self.limit, out))


def wrap(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def to_base(pose):
    """Pose of the laser frame in the frame of the truck."""
    c, s = math.cos(LASER_YAW), math.sin(LASER_YAW)
    x = LASER_X + c * pose.x - s * pose.y
    y = LASER_Y + s * pose.x + c * pose.y
    return x, y, wrap(pose.theta + LASER_YAW)


class PalletForks(object):
    def __init__(self):
        self.max_speed = rospy.get_param("~max_speed", 0.5)
        self.creep_speed = rospy.get_param("~creep_speed", 0.2)
        self.k_lateral = rospy.get_param("~k_lateral", 0.9)
        self.heading_pid = PID(kp=1.4, ki=0.0, kd=0.05, limit=0.5)
        self.pallet = None
        self.seen = rospy.Time(0)
        self.loaded = False
        self.state = "APPROACH"
        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.state_pub = rospy.Publisher("forks/state", String, queue_size=1)
        rospy.Subscriber("pallet/pose", Pose2D, self.pallet_cb)
        rospy.Subscriber("forks/switch", Bool, self.switch_cb)

    def pallet_cb(self, msg):
        self.pallet = to_base(msg)
        self.seen = rospy.Time.now()

    def switch_cb(self, msg):
        self.loaded = msg.data

    def errors(self):
        """Distance, lateral offset and heading of the truck in the frame of the pallet."""
        x, y, yaw = self.pallet
        along = x * math.cos(yaw) + y * math.sin(yaw)
        aside = x * math.sin(yaw) - y * math.cos(yaw)
        return along, aside, -yaw

    def speed(self, along):
        if along < FORK_LENGTH + 0.4:
            return self.creep_speed
        return min(self.max_speed, 0.4 * along)

    def control(self, dt):
        cmd = Twist()
        if self.pallet is None or (rospy.Time.now() - self.seen).to_sec() > 1.0:
            self.cmd_pub.publish(cmd)
            return
        along, aside, heading = self.errors()
        if self.loaded or along < INSERTED:
            self.state = "LOADED"
        if self.state == "APPROACH":
            wanted = math.atan(-self.k_lateral * aside)
            cmd.linear.x = self.speed(along)
            cmd.angular.z = self.heading_pid.update(wrap(wanted - heading), dt)
        self.cmd_pub.publish(cmd)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("pallet_forks")
    node = PalletForks()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        node.control(0.1)
        rate.sleep()
