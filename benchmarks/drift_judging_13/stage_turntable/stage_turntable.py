#!/usr/bin/env python
# Revolving stage of the main house: turn to the angle of each cue, and hold it with the brake.
import math

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

COUNTS_PER_REV = 2048.0  # encoder on the shaft of the motor
GEARBOX = 24.0
WHEEL_RADIUS = 0.125  # radius of the rubber wheel that drives the rim (m)
RIM_RADIUS = 4.5  # m

MAX_RIM_SPEED = 0.95  # m/s; people stand on the stage
RIM_ACCEL = 0.45  # m/s2
KP = 1.1  # gain near the target angle (1/s)
DEADBAND = math.radians(0.3)
RATE = 5.0  # Hz


def clamp(value, limit):
    return max(-limit, min(limit, value))


class Turntable(object):
    def __init__(self):
        self.counts = 0
        self.target = 0.0
        self.rim_speed = 0.0
        self.estop = False
        self.state = "HELD"
        self.motor_pub = rospy.Publisher("turntable/motor_rpm", Float32, queue_size=1)
        self.brake_pub = rospy.Publisher("turntable/brake", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("turntable/state", String, queue_size=1)
        rospy.Subscriber("turntable/encoder", Int32, self.encoder_cb)
        rospy.Subscriber("show/cue", Float32, self.cue_cb)
        rospy.Subscriber("show/estop", Bool, self.estop_cb)

    def encoder_cb(self, msg):
        self.counts = msg.data

    def cue_cb(self, msg):
        angle = math.radians(msg.data)
        if abs(angle - self.target) > DEADBAND:
            self.state = "TURNING"
        self.target = angle

    def estop_cb(self, msg):
        self.estop = msg.data

    def angle(self):
        """Angle of the stage since the start of the show."""
        wheel = 2.0 * math.pi * self.counts / (COUNTS_PER_REV * GEARBOX)
        return wheel * WHEEL_RADIUS / RIM_RADIUS

    def plan(self, error):
        """Speed of the rim: a ramp up, then slower towards the angle."""
        wanted = clamp(KP * error * RIM_RADIUS, MAX_RIM_SPEED)
        braking = math.sqrt(2.0 * RIM_ACCEL * abs(error) * RIM_RADIUS)
        wanted = clamp(wanted, braking)
        step = RIM_ACCEL / RATE
        self.rim_speed += clamp(wanted - self.rim_speed, step)
        return self.rim_speed

    def to_rpm(self, rim_speed):
        return rim_speed / WHEEL_RADIUS * GEARBOX * 60.0 / (2.0 * math.pi)

    def hold(self):
        self.rim_speed = 0.0
        self.motor_pub.publish(0.0)
        self.brake_pub.publish(True)

    def update(self):
        if self.estop:
            self.state = "ESTOP"
            self.hold()
        elif self.state == "TURNING":
            error = self.target - self.angle()
            if abs(error) < DEADBAND and abs(self.rim_speed) < 0.1:
                self.state = "HELD"
                self.hold()
            else:
                self.brake_pub.publish(False)
                self.motor_pub.publish(self.to_rpm(self.plan(error)))
        else:
            self.hold()
        self.state_pub.publish(self.state)

    def run(self):
        rate = rospy.Rate(RATE)
        while not rospy.is_shutdown():
            self.update()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("stage_turntable")
    try:
        Turntable().run()
    except rospy.ROSInterruptException:
        pass
