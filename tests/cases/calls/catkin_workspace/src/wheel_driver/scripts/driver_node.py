#!/usr/bin/env python3
import rospy
from wheel_driver import Driver

if __name__ == "__main__":
    rospy.init_node("driver")
    Driver().start()
    rospy.spin()
