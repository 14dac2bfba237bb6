#!/usr/bin/env python
# -*- coding: utf-8 -*-
"""Boarding program of a ferris wheel: stop one gondola after the other at the platform."""

import math

import rospy
from sensor_msgs.msg import RelativeHumidity
from std_msgs.msg import Bool, Float32, Int32

GONDOLAS = 12
PITCH = 2.0 * math.pi / GONDOLAS

cruise = 0.11  # rad/s
accel = 0.05  # rad/s^2, set in the inverter
brake_decel = 0.055  # deceleration by the brake shoes on the rim (rad/s^2)
brake_delay = 0.25  # time until the shoes touch (s)
boarding_time = 4.0  # s
wet = 85.0  # humidity (%) above which the roofs of the gondolas are closed

angle = None
last_angle = None
last_stamp = None
speed = 0.0
humidity = 40.0
door_open = False


def wheel_callback(msg):
    """Keep angle and speed of the wheel."""
    global angle, last_angle, last_stamp, speed
    now = rospy.get_time()
    if last_stamp is not None and now > last_stamp:
        raw = (msg.data - last_angle) / (now - last_stamp)
        speed = 0.6 * speed + 0.4 * raw
    angle = msg.data
    last_angle, last_stamp = msg.data, now


def humidity_callback(msg):
    global humidity
    humidity = msg.relative_humidity


def door_callback(msg):
    global door_open
    door_open = msg.data


def stopping_angle(omega):
    """Angle by which the wheel turns on after the brake is set."""
    return omega * brake_delay + omega**2 / (2.0 * brake_decel)


def main():
    rospy.init_node("ferris_wheel")
    drive = rospy.Publisher("wheel/drive", Float32, queue_size=1)
    brake = rospy.Publisher("wheel/brake", Bool, queue_size=1)
    roofs = rospy.Publisher("gondolas/roofs", Bool, queue_size=1)
    at_platform = rospy.Publisher("platform/gondola", Int32, queue_size=1, latch=True)
    rospy.Subscriber("wheel/angle", Float32, wheel_callback)
    rospy.Subscriber("weather/humidity", RelativeHumidity, humidity_callback)
    rospy.Subscriber("platform/door", Bool, door_callback)

    state = "board"
    gondola = 0
    since = rospy.get_time()
    command = 0.0
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        now = rospy.get_time()
        if angle is None:
            rate.sleep()
            continue
        if state == "board":
            roofs.publish(humidity > wet)
            drive.publish(0.0)
            brake.publish(True)
            if now - since > boarding_time and not door_open:
                gondola += 1
                state = "turn"
                rospy.loginfo("gondola %d is next", gondola % GONDOLAS)
        elif state == "turn":
            command = min(cruise, command + accel * 0.1)
            left = gondola * PITCH - angle
            if left < stopping_angle(speed):
                state = "brake"
                brake.publish(True)
                drive.publish(0.0)
                command = 0.0
            else:
                brake.publish(False)
                drive.publish(command)
        elif state == "brake":
            brake.publish(True)
            if abs(speed) < 0.002:
                at_platform.publish(gondola)
                since = now
                state = "board"
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
