#!/usr/bin/env python3
import rospy
from std_msgs.msg import Bool, Float32

TUB = 38.0  # mass of an empty tub (g)
AFTERRUN = 2.5  # mass that still falls when the flap closes (g)

scale = {"gross": 0.0}
rospy.init_node("portion")
rospy.Subscriber("/scale", Float32, lambda msg: scale.update(gross=msg.data))
rospy.Subscriber("/order", Float32, lambda msg: scale.update(order=msg.data))
flap = rospy.Publisher("/flap", Float32, queue_size=1)
ready = rospy.Publisher("/ready", Bool, queue_size=1)

rate = rospy.Rate(10)
while not rospy.is_shutdown():
    net = scale["gross"] - TUB
    missing = scale.get("order", 0.0) - AFTERRUN - net
    if net < -15.0 or missing <= 0.0:  # there is no tub, or it is full
        flap.publish(0.0)
    elif missing < 25.0:
        flap.publish(0.3)
    else:
        flap.publish(1.0)
    ready.publish(net > -15.0 and missing <= 0.0)
    rate.sleep()
