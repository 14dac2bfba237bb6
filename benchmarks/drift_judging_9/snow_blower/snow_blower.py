#!/usr/bin/env python
# Snow blower: drive along a pavement as fast as the auger takes the snow, and turn the chute away from houses.
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float32

RATE = 10
WIDTH = 0.7  # width of the auger (m)
INTAKE = 0.16  # flow of snow that the auger takes (m^3/s)
V_MAX = 0.9  # m/s
V_MIN = 0.08  # the tracks stall at lower speeds (m/s)
V_BACK = -0.15  # speed out of a bank (m/s)
BANK = 1.1  # deeper snow is a bank, not snowfall (m)
DEPTH_FILTER = 0.35
ACCEL = 0.5  # m/s^2
CHUTE_LEFT, CHUTE_RIGHT = 1.2, -1.2  # rad
HOUSE_NEAR = 4.0  # m

depth = 0.0
house = 10.0
running = False
speed = 0.0


def on_depth(msg):
    global depth
    depth = depth + DEPTH_FILTER * (msg.data - depth)


def on_house(msg):
    global house
    house = msg.data


def on_enable(msg):
    global running
    running = msg.data


def wanted_speed():
    if not running:
        return 0.0
    if depth > BANK:
        return V_BACK
    if depth < 0.02:
        return V_MAX
    return max(V_MIN, min(V_MAX, INTAKE / (WIDTH * depth)))


def ramp(now, wanted):
    step = ACCEL / RATE
    return now + max(-step, min(step, wanted - now))


def chute_angle():
    return CHUTE_RIGHT if house < HOUSE_NEAR else CHUTE_LEFT


if __name__ == "__main__":
    rospy.init_node("snow_blower")
    drive = rospy.Publisher("tracks/cmd", Twist, queue_size=1)
    chute = rospy.Publisher("chute/angle", Float32, queue_size=1)
    rospy.Subscriber("snow/depth", Float32, on_depth)
    rospy.Subscriber("house/range", Float32, on_house)
    rospy.Subscriber("mission/enable", Bool, on_enable)
    rate = rospy.Rate(RATE)
    while not rospy.is_shutdown():
        speed = ramp(speed, wanted_speed())
        cmd = Twist()
        cmd.linear.x = speed
        drive.publish(cmd)
        chute.publish(chute_angle())
        rate.sleep()
