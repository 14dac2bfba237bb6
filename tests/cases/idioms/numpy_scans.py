"""numpy on scans and clouds: masks, `where`, slices, `reshape`, in-place writes, reductions, shapes."""

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, Float32MultiArray, Int32, MultiArrayDimension


class Analyzer:
    def __init__(self):
        self.window = np.zeros((5, 3), dtype=np.float32)
        self.weights = np.array([0.2, 0.3, 0.5])
        self.grid = None
        self.origin = np.zeros(2)
        self.near = rospy.Publisher("near", Float32, queue_size=1)
        self.bearing = rospy.Publisher("bearing", Float32, queue_size=1)
        self.sectors = rospy.Publisher("sectors", Float32MultiArray, queue_size=1)
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.free = rospy.Publisher("free", Int32, queue_size=1)
        self.kernel = rospy.Publisher("kernel", Float32MultiArray, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("map", OccupancyGrid, self.on_map)  # source map

    def on_map(self, msg):
        info = msg.info
        self.grid = np.asarray(msg.data, dtype=np.int8).reshape(info.height, info.width)
        self.origin[:] = info.origin.position.x, info.origin.position.y

    def on_scan(self, msg):
        ranges = np.array(msg.ranges)
        ranges[~np.isfinite(ranges)] = msg.range_max
        ranges = np.where(ranges < msg.range_min, msg.range_max, ranges)
        self.near.publish(ranges.min())  # sink scan
        self.bearing.publish(msg.angle_min + np.argmin(ranges) * msg.angle_increment)  # sink scan
        thirds = np.array([part.mean() for part in np.array_split(ranges, 3)])
        self.window = np.roll(self.window, 1, axis=0)
        self.window[0, :] = thirds
        out = Float32MultiArray()
        out.layout.dim.append(MultiArrayDimension(label="sector", size=3, stride=3))
        out.data = self.window.mean(axis=0).tolist()
        self.sectors.publish(out)  # sink scan
        twist = Twist()
        left, _, right = self.window[0]
        twist.linear.x = 0.4
        twist.angular.z = float(np.sign(left - right)) * 0.3
        self.cmd.publish(twist)  # sink scan
        self.kernel.publish(Float32MultiArray(data=list(self.weights / self.weights.sum())))  # clean
        if self.grid is not None:
            self.free.publish(int(np.count_nonzero(self.grid == 0)))  # sink map
            self.near.publish(np.linalg.norm(self.origin))  # sink map
            self.free.publish(self.grid.shape[0])  # sink map


if __name__ == "__main__":
    rospy.init_node("analyzer")
    Analyzer()
    rospy.spin()
