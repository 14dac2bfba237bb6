#!/usr/bin/env python3
# Night rounds through the doors of a corridor. A door that does not open when pushed is locked: take the detour.
"""Push swing doors open, or request a detour."""

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float32, String

DRIVE = 0.7  # m/s
PUSH = 0.15  # speed with the bumper against the door (m/s)
TOUCH = 0.08  # distance below which the bumper touches the door (m)
SLOW_FROM = 0.6  # m
OPEN_GAP = 1.0  # free distance that shows an open door (m)
PATIENCE = 2.5  # s
BACK_OFF = 0.3  # m/s

gap = None
state = "drive"
since = 0.0
status_pub = None


def scan_callback(scan):
    """Keep the shortest valid range ahead."""
    global gap
    valid = [r for r in scan.ranges if scan.range_min <= r <= scan.range_max]
    gap = min(valid) if valid else scan.range_max


def change(new, now):
    """Go to another state."""
    global state, since
    rospy.logdebug("%s -> %s", state, new)
    state, since = new, now


def drive_speed():
    """Return full speed, and less in front of a door."""
    if gap > SLOW_FROM:
        return DRIVE
    return max(PUSH, DRIVE * gap / SLOW_FROM)


def step(now):
    """Return the speed for this cycle."""
    if state == "drive":
        if gap < TOUCH:
            change("push", now)
            return PUSH
        return drive_speed()
    if state == "push":
        if gap > OPEN_GAP:
            change("drive", now)
        elif now - since > PATIENCE:
            change("detour", now)
        return PUSH
    # detour: back off a little, then the fleet manager takes over
    return -BACK_OFF if now - since < 0.5 else 0.0


def main():
    """Run the loop."""
    rospy.init_node("corridor")
    rospy.Subscriber("/scan", LaserScan, scan_callback)
    speed_pub = rospy.Publisher("/speed", Float32, queue_size=1)
    detour_pub = rospy.Publisher("/detour", Bool, queue_size=1)
    state_pub = rospy.Publisher("/state", String, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        if gap is not None:
            speed_pub.publish(step(rospy.get_time()))
            detour_pub.publish(state == "detour")
            state_pub.publish(state)
        rate.sleep()


if __name__ == "__main__":
    main()
