import rospy
import dynamic_reconfigure.server
from dynamic_reconfigure.server import Server
from ackermann_msgs.msg import AckermannDriveStamped
from sensor_msgs.msg import LaserScan, PointCloud
from std_msgs.msg import Float32, Float64
import numpy as np
import math


class GapFollower(object):
    """ Reactive gap follower. """
    BUBBLE = 0.3

    def __init__(self, params=None):
        self.params = params or {}
        self.drive_pub = rospy.Publisher(self.params.get('drive', '/drive'), AckermannDriveStamped, queue_size=5)
        self.angle_pub = rospy.Publisher('angle', Float32, queue_size=1)
        self.beams_pub = rospy.Publisher('beams', Float32, queue_size=1)
        self.conf_pub = rospy.Publisher('max_speed', Float32, queue_size=1)
        self.scan_sub = rospy.Subscriber('/scan', LaserScan, self.lidar_callback)  # source scan
        self.srv = Server(object, self.reconfigure)
        self.prev_error, self.integral = 0.0, 0.0
        self.max_speed = 2.0
        self.servo = None

    def reconfigure(self, config, level):
        self.max_speed = config['max_speed']
        return config

    def preprocess(self, ranges, angle_min, angle_inc):
        proc = np.array(ranges)
        proc[proc > 3.0] = 3.0
        n = 5
        kernel = np.ones(n) / n
        proc = np.convolve(proc, kernel, mode='same')
        closest = np.argmin(proc)
        r = int(math.atan2(self.BUBBLE, proc[closest]) / angle_inc)
        lo, hi = max(0, closest - r), min(len(proc), closest + r)
        proc[lo:hi] = 0
        return proc

    @staticmethod
    def max_gap(free):
        masked = np.ma.masked_where(free == 0, free)
        slices = np.ma.notmasked_contiguous(masked)
        best = slices[0]
        for sl in slices[1:]:
            if sl.stop - sl.start > best.stop - best.start:
                best = sl
        return best.start, best.stop

    def best_point(self, start, stop, ranges):
        return (start + stop) // 2 if ranges[start] > 1.0 else start

    def lidar_callback(self, data):
        proc = self.preprocess(data.ranges, data.angle_min, data.angle_increment)
        start, stop = self.max_gap(proc)
        best = self.best_point(start, stop, proc)
        angle = data.angle_min + best * data.angle_increment
        msg = AckermannDriveStamped()
        msg.header.stamp = rospy.Time.now()
        msg.header.frame_id = 'laser'
        msg.drive.steering_angle = self.pid(angle)
        msg.drive.speed = self.speed(angle)
        self.drive_pub.publish(msg)  # sink scan
        self.angle_pub.publish(angle)  # sink scan
        self.beams_pub.publish(len(data.ranges))  # sink scan
        self.conf_pub.publish(self.max_speed)  # clean

    def pid(self, error, dt=0.1):
        self.integral += error * dt
        u = 0.5 * error + 0.01 * self.integral + 0.1 * (error - self.prev_error) / dt
        self.prev_error = error
        return np.clip(u, -0.4, 0.4)

    def speed(self, angle):
        for limit, speed in ((10, 1.5), (20, 1.0), (90, 0.5)):
            if abs(math.degrees(angle)) < limit:
                return min(speed, self.max_speed)
        return 0.0


if __name__ == '__main__':
    rospy.init_node('gap')
    GapFollower(rospy.get_param('~'))
    rospy.spin()
