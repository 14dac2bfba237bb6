#!/usr/bin/env python3
import rospy
import cv2
import numpy as np
from collections import deque
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Twist, Point
from sensor_msgs.msg import Image, CameraInfo, LaserScan
from std_msgs.msg import Bool


class PersonTracker(object):
    def __init__(self, maxlen=5):
        self.centers = deque(maxlen=maxlen)
        self.last_seen = None

    def update(self, box):
        x, y, w, h = box  # step image
        self.centers.append((x + w / 2.0, y + h / 2.0))  # step image
        self.last_seen = rospy.Time.now()

    @property
    def smoothed(self):
        if not self.centers:  # step ~image
            return None
        xs = [c[0] for c in self.centers]  # step image
        return sum(xs) / len(xs)  # step image

    def lost(self, timeout):
        return self.last_seen is None or (rospy.Time.now() - self.last_seen).to_sec() > timeout


class PersonFollower:
    def __init__(self):
        self.bridge = CvBridge()
        self.tracker = PersonTracker()
        self.width = 640
        self.min_front = float("inf")
        self.enabled = True
        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.debug_pub = rospy.Publisher("~debug", Image, queue_size=1)
        self.alive_pub = rospy.Publisher("~alive", Bool, queue_size=1)
        rospy.Subscriber("camera/image", Image, self.on_image, queue_size=1, buff_size=2**24)  # source image
        rospy.Subscriber("camera/info", CameraInfo, self.on_info)  # source info
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("enable", Bool, self.on_enable)  # source enable

    def on_info(self, info):
        self.width = info.width  # step info

    def on_scan(self, scan):
        ranges = np.asarray(scan.ranges)  # step scan
        ranges[np.isinf(ranges)] = scan.range_max  # step scan
        mid = len(ranges) // 2  # step scan
        self.min_front = np.min(ranges[mid - 10:mid + 10])  # step scan

    def on_enable(self, msg):
        self.enabled = msg.data  # step ~enable

    def on_image(self, msg):
        try:
            frame = self.bridge.imgmsg_to_cv2(msg, "bgr8")  # step image
        except CvBridgeError as e:
            rospy.logerr(e)
            return
        hsv = cv2.cvtColor(frame, cv2.COLOR_BGR2HSV)  # step image
        mask = cv2.inRange(hsv, (20, 100, 100), (30, 255, 255))  # step image
        contours, _ = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)  # step image
        if contours:  # step ~image
            biggest = max(contours, key=cv2.contourArea)  # step image
            box = cv2.boundingRect(biggest)  # step image
            self.tracker.update(box)  # step image
            cv2.rectangle(frame, (box[0], box[1]), (box[0] + box[2], box[1] + box[3]), (0, 255, 0), 2)  # step image
        self.debug_pub.publish(self.bridge.cv2_to_imgmsg(frame, "bgr8"))  # sink image

    def spin(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            self.alive_pub.publish(True)  # clean
            cmd = Twist()
            target = self.tracker.smoothed  # step image
            if self.enabled and target is not None and not self.tracker.lost(1.0):  # step ~enable ~image
                err = (target - self.width / 2) / self.width  # step image info
                cmd.angular.z = -0.8 * err  # step image info
                if self.min_front > 0.8:  # step ~scan
                    cmd.linear.x = min(0.5, 0.4 * (self.min_front - 0.8))  # step scan
            self.cmd_pub.publish(cmd)  # sink image info scan ~enable
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("person_follower")
    PersonFollower().spin()
