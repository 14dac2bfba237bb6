#!/usr/bin/env python
import math

import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float32

LEAF = 40.0  # unbalanced moment of the closed leaf (kNm)
KP = 60.0
KD = 45.0
OPEN = 1.2  # rad
PACE = 0.06  # rad/s
TORQUE_MAX = 160.0


class BasculeBridge(object):
    def __init__(self):
        self.angle = None
        self.rate = 0.0
        self.wanted = 0.0
        self.ship = False
        self.rain = 0.0
        self.torque = rospy.Publisher("leaf/torque", Float32, queue_size=1)
        self.lamp = rospy.Publisher("ship_lamp", Bool, queue_size=1)
        rospy.Subscriber("leaf/joint", JointState, self.joint_cb)
        rospy.Subscriber("ship_waits", Bool, self.ship_cb)
        rospy.Subscriber("rain_gauge", Float32, self.rain_cb)

    def joint_cb(self, msg):
        self.angle = msg.position[0]
        self.rate = 0.6 * self.rate + 0.4 * msg.velocity[0]

    def ship_cb(self, msg):
        self.ship = msg.data

    def rain_cb(self, msg):
        if abs(msg.data - self.rain) > 5.0:
            rospy.loginfo("rain in the last day: %.0f mm", msg.data)
        self.rain = msg.data

    def step(self, dt):
        if self.angle is None or not self.ship:
            return
        self.wanted = min(OPEN, self.wanted + PACE * dt)
        weight = LEAF * math.cos(self.angle)
        torque = weight + KP * (self.wanted - self.angle) - KD * self.rate
        self.torque.publish(max(-TORQUE_MAX, min(TORQUE_MAX, torque)))
        self.lamp.publish(self.angle > OPEN - 0.1)


if __name__ == "__main__":
    rospy.init_node("bascule_bridge")
    bridge = BasculeBridge()
    while not rospy.is_shutdown():
        bridge.step(0.2)
        rospy.sleep(0.2)
