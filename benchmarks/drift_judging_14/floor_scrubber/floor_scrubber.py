#!/usr/bin/env python
# Scrub the lanes of a market hall, and go back for a fresh battery pack in time.
#
# The pack has a flat discharge curve, so its voltage tells little; the charge is counted instead.
import math

import rospy
from geometry_msgs.msg import Point
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, String

CAPACITY = 3.0  # capacity of a pack (Ah)
RESERVE = 0.2  # charge that is never used (Ah)
DRIVE_CURRENT = 11.0  # current with brush and pump off (A)

LANES = 8
LANE_WIDTH = 1.5  # m
LANE_LENGTH = 24.0  # m
SPEED = 0.5  # speed while scrubbing (m/s)
TRANSIT_SPEED = 0.8  # m/s
DOCK = (0.0, 0.0)
NEAR = 0.5  # m
RATE = 0.5  # Hz

position = None
used = 0.0
swapped = False
last_stamp = None


def odom_cb(msg):
    global position
    position = (msg.x, msg.y)


def battery_cb(msg):
    """Count the charge that leaves the pack; the dock tells when it has put in a fresh one."""
    global used, last_stamp, swapped
    now = rospy.get_time()
    if msg.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_FULL:
        used, swapped = 0.0, True
    elif last_stamp is not None:
        used += abs(msg.current) * (now - last_stamp) / 3600.0
    last_stamp = now
    rospy.logdebug_throttle(60, "%.1f V, %.2f Ah used" % (msg.voltage, used))


def distance(a, b):
    return math.hypot(a[0] - b[0], a[1] - b[1])


def waypoints():
    """Ends of the lanes, one after the other, there and back."""
    for lane in range(LANES):
        y = (lane + 0.5) * LANE_WIDTH
        ends = [(1.0, y), (1.0 + LANE_LENGTH, y)]
        for end in ends if lane % 2 == 0 else reversed(ends):
            yield end


def charge_home():
    """Charge in Ah that the way back to the dock needs."""
    return DRIVE_CURRENT * distance(position, DOCK) / TRANSIT_SPEED / 3600.0


def drive(pub, goal, speed):
    """Publish the velocity towards a goal; return whether it is reached."""
    left = distance(position, goal)
    if left < NEAR:
        return True
    scale = min(speed, 0.25 * left) / left
    pub.publish(x=(goal[0] - position[0]) * scale, y=(goal[1] - position[1]) * scale)
    return False


def run():
    global swapped
    velocity_pub = rospy.Publisher("base/velocity", Point, queue_size=1)
    brush_pub = rospy.Publisher("brush", Bool, queue_size=1)
    state_pub = rospy.Publisher("scrubber/state", String, queue_size=1)
    rospy.Subscriber("odom", Point, odom_cb)
    rospy.Subscriber("battery", BatteryState, battery_cb)
    todo = list(waypoints())
    state, resume = "SCRUB", None
    rate = rospy.Rate(RATE)
    while not rospy.is_shutdown():
        rate.sleep()
        if position is None:
            continue
        if state == "SCRUB":
            left = CAPACITY - used
            if left < RESERVE + charge_home():
                state, resume = "HOME", position
            elif drive(velocity_pub, todo[0], SPEED):
                todo.pop(0)
                if not todo:
                    state = "HOME"
        elif state == "HOME":
            if drive(velocity_pub, DOCK, TRANSIT_SPEED):
                state, swapped = "SWAP", False
        elif state == "SWAP":
            velocity_pub.publish(x=0.0, y=0.0)
            if swapped and todo:
                state = "RETURN"
        elif state == "RETURN":
            if drive(velocity_pub, resume, TRANSIT_SPEED):
                state = "SCRUB"
        brush_pub.publish(state == "SCRUB")
        state_pub.publish(state)


if __name__ == "__main__":
    rospy.init_node("floor_scrubber")
    run()
