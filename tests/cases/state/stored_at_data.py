"""If data gives the index of a stored constant, the container depends on that data, and the store is a step."""

import numpy as np
import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, Int32


def on_scan(msg):
    ranges = np.array(msg.ranges)  # step scan
    closest = ranges.argmin()  # step scan
    low = closest - 10  # step scan
    free = np.ones(360)
    free[low : low + 20] = 0  # step scan
    gap.publish(int(free.argmax()))  # sink scan
    table = [0.0] * 10
    table[3] = 1.0
    fixed.publish(table[3])  # clean


gap = rospy.Publisher("gap", Int32, queue_size=1)
fixed = rospy.Publisher("fixed", Float64, queue_size=1)
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.spin()
