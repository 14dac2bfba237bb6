#!/usr/bin/env python
# motor assistance of a cargo bike. torque in [Nm], speed in [m/s], current in [A]

import rospy
from geometry_msgs.msg import Vector3Stamped
from std_msgs.msg import Float32, UInt8

state = {"cadence": 0.0, "torque": 0.0, "speed": 0.0, "grade": 0.0, "load": 0.0, "temp": 25.0}
last = {"current": 0.0, "pedal": None}


def pedal_cb(msg):
    # x: crank torque, y: cadence in rev/min
    state["torque"] = 0.8 * state["torque"] + 0.2 * msg.vector.x
    state["cadence"] = msg.vector.y
    last["pedal"] = rospy.get_time()


def scalar_cb(msg, key):
    state[key] = msg.data


def load_cb(msg):
    state["load"] = msg.data
    if state["load"] > rospy.get_param("~max_load", 120.0):
        rospy.logwarn_throttle(5.0, "box holds %.0f kg" % state["load"])


def taper(speed, begin, end):
    """share of the assistance that is left at a speed"""
    if speed <= begin:
        return 1.0
    if speed >= end:
        return 0.0
    return (end - speed) / (end - begin)


def cooling(temp):
    return taper(temp, 85.0, 105.0)


def assistance(levels, level):
    amps_per_nm = 0.42
    factor = levels[min(level, len(levels) - 1)]
    wanted = factor * amps_per_nm * state["torque"]
    if state["grade"] > 0.06:
        wanted *= 1.15
    return wanted * taper(state["speed"], 6.4, 7.2) * cooling(state["temp"])


def limited(wanted, rise, fall, i_max, dt):
    step = max(-fall * dt, min(rise * dt, wanted - last["current"]))
    last["current"] = max(0.0, min(i_max, last["current"] + step))
    return last["current"]


def main():
    rospy.init_node("cargo_bike")
    levels = rospy.get_param("~levels", [0.0, 0.7, 1.1, 1.5])
    level = rospy.get_param("~level", 1)
    i_max = rospy.get_param("~max_current", 24.0)
    hz = rospy.get_param("~hz", 10)
    rospy.Subscriber("bike/pedal", Vector3Stamped, pedal_cb)
    rospy.Subscriber("bike/speed", Float32, scalar_cb, "speed")
    rospy.Subscriber("bike/grade", Float32, scalar_cb, "grade")
    rospy.Subscriber("motor/temperature", Float32, scalar_cb, "temp")
    rospy.Subscriber("box/load", Float32, load_cb)
    pub = rospy.Publisher("motor/current", Float32, queue_size=1)
    level_pub = rospy.Publisher("display/level", UInt8, queue_size=1, latch=True)
    level_pub.publish(level)
    rate = rospy.Rate(hz)
    while not rospy.is_shutdown():
        pedalling = last["pedal"] is not None and rospy.get_time() - last["pedal"] < 0.5
        pedalling = pedalling and state["cadence"] > 12.0
        wanted = assistance(levels, level) if pedalling else 0.0
        pub.publish(limited(wanted, 15.0, 60.0, i_max, 1.0 / hz))
        rate.sleep()


if __name__ == "__main__":
    main()
