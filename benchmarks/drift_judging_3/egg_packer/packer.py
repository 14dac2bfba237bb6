#!/usr/bin/env python3
"""Lift eggs from a tray into cartons with a soft gripper. One function makes up the node."""

import rclpy
from std_msgs.msg import Float32, String

TICK = 0.05  # s
DENSITY = 1.09e-3  # g/mm3
SHAPE = 0.5236 * 1.33  # ratio of the volume of an egg to the cube of its width
NEWTON_PER_GRAM = 0.0102
CLOSE_TIME = 0.3  # s
LIFT_ACCELERATION = 1.5  # m/s2
LIFT_SPEED = 0.4  # m/s
LIFT_HEIGHT = 0.15  # m


def weight_of(width):
    """Estimate the weight of an egg from its width (mm)."""
    return DENSITY * SHAPE * width**3


def force_for(width):
    """Return the gripping force that an egg needs, N."""
    return NEWTON_PER_GRAM * weight_of(width)


def main():
    """Create the node from closures and spin it."""
    rclpy.init()
    node = rclpy.create_node("packer")
    grip = node.create_publisher(Float32, "grip/force", 1)
    lift = node.create_publisher(Float32, "lift/speed", 1)
    phase = node.create_publisher(String, "packer/phase", 1)
    width, height = None, 0.0
    state, ticks, speed = "wait", 0, 0.0

    def on_width(msg):
        nonlocal width, state, ticks, speed
        if msg.data <= 0.0:
            width, state = None, "wait"
        elif width is None:
            width = msg.data
            state, ticks, speed = "close", 0, 0.0

    def on_height(msg):
        nonlocal height
        height = msg.data

    def lift_speed():
        nonlocal speed
        left = LIFT_HEIGHT - height
        stoppable = (2.0 * LIFT_ACCELERATION * max(0.0, left)) ** 0.5
        speed = min(speed + LIFT_ACCELERATION * TICK, LIFT_SPEED, stoppable)
        return speed

    def tick():
        nonlocal state, ticks
        force = 0.0 if state == "wait" else force_for(width)
        up = 0.0
        if state == "close":
            ticks += 1
            if ticks * TICK >= CLOSE_TIME:
                state = "lift"
        elif state == "lift":
            up = lift_speed()
            if height > LIFT_HEIGHT - 0.01:
                state = "place"
        grip.publish(Float32(data=force))
        lift.publish(Float32(data=up))
        phase.publish(String(data=state))

    node.create_subscription(Float32, "tray/width", on_width, 1)
    node.create_subscription(Float32, "lift/height", on_height, 1)
    node.create_timer(TICK, tick)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
