"""Goal following with helper math, lists of waypoints and early returns."""

import math

import numpy as np
import rospy
from geometry_msgs.msg import Point, PoseStamped, Twist
from nav_msgs.msg import Odometry, Path
from std_msgs.msg import Bool, Float64
from tf.transformations import euler_from_quaternion


class Follower(object):
    MAX_SPEED = 0.5

    def __init__(self, waypoints):
        self.pose = np.zeros(3)
        self.waypoints = waypoints
        self.index = 0
        self.path = []
        self.errors = []
        self.done_pub = rospy.Publisher("done", Bool, queue_size=1, latch=True)
        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.err_pub = rospy.Publisher("error", Float64, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.odom_cb, queue_size=1)  # source odom
        rospy.Subscriber("path", Path, self.path_cb)  # source path

    def odom_cb(self, msg):
        p = msg.pose.pose.position
        q = msg.pose.pose.orientation
        yaw = euler_from_quaternion((q.x, q.y, q.z, q.w))[2]
        self.pose = np.array([p.x, p.y, yaw])

    def path_cb(self, msg):
        self.path = [(ps.pose.position.x, ps.pose.position.y) for ps in msg.poses]

    @staticmethod
    def wrap(angle):
        while angle > math.pi:
            angle -= 2 * math.pi
        return angle

    def error_to(self, goal):
        dx, dy = goal[0] - self.pose[0], goal[1] - self.pose[1]
        return math.hypot(dx, dy), self.wrap(math.atan2(dy, dx) - self.pose[2])

    def step(self):
        goal = self.waypoints[self.index]
        distance, turn = self.error_to(goal)
        self.errors.append(distance)
        self.err_pub.publish(distance)  # sink odom
        self.err_pub.publish(np.mean(self.errors))  # sink odom
        self.err_pub.publish(goal[0])  # sink ~odom
        if distance < 0.1:
            self.index += 1
            self.done_pub.publish(True)  # sink ~odom
            return
        cmd = Twist()
        cmd.linear.x = min(distance, self.MAX_SPEED)
        cmd.angular.z = turn if abs(turn) > 0.1 else 0.0
        self.cmd_pub.publish(cmd)  # sink odom
        self.err_pub.publish(self.MAX_SPEED)  # sink ~odom

    def follow(self):
        for x, y in self.path:
            distance, _ = self.error_to((x, y))
            self.err_pub.publish(distance)  # sink odom path
            self.err_pub.publish(x)  # sink path ~odom

    def run(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown() and self.index < len(self.waypoints):
            self.step()
            self.follow()
            rate.sleep()
        self.cmd_pub.publish(Twist())  # clean


if __name__ == "__main__":
    rospy.init_node("follower")
    Follower([(0.0, 0.0), (1.0, 1.0)]).run()
