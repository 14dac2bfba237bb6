"""Kinematics of a tractor with one trailer, backwards."""

import math

WHEELBASE = 2.1  # m
AXLE_TO_HITCH = 3.4  # m, from the trailer's axle to the hitch


def limited(value, most):
    return max(-most, min(most, value))


def joint_for(bend):
    """Return the angle of the joint at which the trailer's path has a bend, in 1/m."""
    return math.atan(AXLE_TO_HITCH * bend)


def steering_for(joint, rate, speed):
    """Return the steering angle for which the joint turns at a rate, at a speed backwards."""
    turning = rate / speed + math.sin(joint) / AXLE_TO_HITCH
    return math.atan(WHEELBASE * turning)
