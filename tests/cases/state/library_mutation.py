import heapq
import random

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import Image
from std_msgs.msg import Float64


class Painter:
    def __init__(self):
        self.bridge = CvBridge()
        self.canvas = np.zeros((100, 100, 3), np.uint8)
        self.blank = np.zeros((100, 100, 3), np.uint8)
        self.nearest = []
        self.order = [1.0, 2.0]
        self.images = rospy.Publisher("image", Image, queue_size=1)
        self.pub = rospy.Publisher("near", Float64, queue_size=1)
        rospy.Subscriber("point", PointStamped, self.on_point)  # source point
        rospy.Subscriber("distance", Float64, self.on_distance)  # source distance
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_point(self, msg):
        center = (int(msg.point.x), int(msg.point.y))
        cv2.circle(self.canvas, center, 3, (0, 255, 0), -1)
        cv2.circle(self.blank, (5, 5), 3, (0, 255, 0), -1)

    def on_distance(self, msg):
        heapq.heappush(self.nearest, msg.data)
        random.shuffle(self.order)

    def tick(self, event):
        self.images.publish(self.bridge.cv2_to_imgmsg(self.canvas, "bgr8"))  # sink point
        self.images.publish(self.bridge.cv2_to_imgmsg(self.blank, "bgr8"))  # clean
        self.pub.publish(heapq.heappop(self.nearest))  # sink distance
        self.pub.publish(self.order[0])  # clean


rospy.init_node("painter")
Painter()
rospy.spin()
