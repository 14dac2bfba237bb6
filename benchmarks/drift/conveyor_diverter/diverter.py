#!/usr/bin/env python3
"""Push parcels off a belt: a gate weighs them, and a pusher further down is timed to push them."""

import rospy
from std_msgs.msg import Float32

PLAN = {
    "travel": 2.0,  # time from gate to pusher (s)
    "hold": 0.35,  # duration of a push (s)
    "push": 0.7,  # share of full force
    "heavy": 4.0,  # weight from which parcels are pushed with full force, kg
}

waiting = []


def on_gate(msg):
    """Plan when to push the parcel that passes the gate."""
    lead = 0.02 * msg.data
    lead = min(lead, 0.15)
    due = rospy.get_time() + PLAN["travel"] - lead
    waiting.append((due, msg.data))


def force_now(now):
    """Return the pushing force at this moment."""
    while waiting and now > waiting[0][0] + PLAN["hold"]:
        waiting.pop(0)
    if not waiting:
        return 0.0
    due, weight = waiting[0]
    if now < due:
        return 0.0
    force = PLAN["push"]
    if weight > PLAN["heavy"]:
        force = 1.0
    return force


def main():
    """Run the node until it is interrupted."""
    rospy.init_node("diverter")
    pusher = rospy.Publisher("/pusher", Float32, queue_size=1)
    rospy.Subscriber("/gate", Float32, on_gate)
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        pusher.publish(force_now(rospy.get_time()))
        rate.sleep()


if __name__ == "__main__":
    main()
