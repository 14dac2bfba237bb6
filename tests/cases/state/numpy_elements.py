import numpy as np
import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, Float64MultiArray


class Grid:
    def __init__(self):
        self.cells = np.zeros((10, 10))
        self.kernel = np.ones((3, 3)) / 9.0
        self.ranges = np.zeros(360)
        self.row = np.zeros(4)
        self.filled = np.empty(3)
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.array = rospy.Publisher("array", Float64MultiArray, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("value", Float64, self.on_value)  # source value
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_scan(self, msg):
        self.ranges[:] = msg.ranges
        self.cells[3, 4] = msg.ranges[0]
        np.copyto(self.row, msg.ranges[:4])

    def on_value(self, msg):
        self.filled.fill(msg.data)
        self.kernel.fill(1.0)

    def tick(self, event):
        self.pub.publish(np.min(self.ranges))  # sink scan
        self.pub.publish(self.ranges.mean())  # sink scan
        self.pub.publish(self.cells[3, 4])  # sink scan
        self.pub.publish(float(self.row[0]))  # sink scan
        self.pub.publish(self.filled.sum())  # sink value
        self.pub.publish(self.kernel.sum())  # clean
        out = Float64MultiArray()
        out.data = self.cells.flatten().tolist()
        self.array.publish(out)  # sink scan
        out = Float64MultiArray()
        out.data = list(self.kernel[0])
        self.array.publish(out)  # clean
        masked = np.where(self.ranges > 1.0, 1.0, 0.0)
        self.pub.publish(masked[0])  # sink scan
        scaled = np.array([1.0, 2.0])
        scaled *= self.filled[:2]
        self.pub.publish(scaled[0])  # sink value


rospy.init_node("grid")
Grid()
rospy.spin()
