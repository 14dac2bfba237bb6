#!/usr/bin/env python
from __future__ import print_function
import sys
import rospy
import cv2
import numpy as np
import message_filters
from std_msgs.msg import String, Float32MultiArray, MultiArrayDimension
from sensor_msgs.msg import Image, RegionOfInterest, PointCloud2
import sensor_msgs.point_cloud2 as pc2
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import PoseArray, Pose, Point


class Depth:
    def __init__(self):
        self.bridge = CvBridge()
        self.bg = None
        self.k = np.eye(3)
        self.kernel = np.ones((5, 5), np.uint8)
        self.alpha = 0.05
        self.mask = np.zeros((480, 640), np.uint8)
        rgb = message_filters.Subscriber('rgb', Image)  # source rgb
        depth = message_filters.Subscriber('depth', Image)  # source depth
        ts = message_filters.ApproximateTimeSynchronizer([rgb, depth], queue_size=5, slop=0.1)
        ts.registerCallback(self.callback)
        self.ts = ts
        rospy.Subscriber('cloud', PointCloud2, self.cloud_cb)  # source cloud
        rospy.Subscriber('roi', RegionOfInterest, self.roi_cb)  # source roi
        self.image_pub = rospy.Publisher('out', Image, queue_size=1)
        self.poses = rospy.Publisher('poses', PoseArray, queue_size=1)
        self.hist = rospy.Publisher('hist', Float32MultiArray, queue_size=1)
        self.kern = rospy.Publisher('kernel', Float32MultiArray, queue_size=1)
        self.roi = (0, 0, 640, 480)

    def roi_cb(self, roi):
        self.roi = roi.x_offset, roi.y_offset, roi.width, roi.height

    def callback(self, rgb, depth):
        try:
            color = self.bridge.imgmsg_to_cv2(rgb, 'bgr8')
            d = self.bridge.imgmsg_to_cv2(depth, desired_encoding='passthrough')
        except CvBridgeError as e:
            print(e)
            return
        x, y, w, h = self.roi
        d = d[y:y + h, x:x + w].astype(np.float32) / 1000.0
        if self.bg is None:
            self.bg = d.copy()
            return
        cv2.accumulateWeighted(d, self.bg, self.alpha)
        diff = cv2.absdiff(d, self.bg)
        cv2.threshold(diff, 0.1, 255, cv2.THRESH_BINARY, dst=self.mask)
        fg = cv2.morphologyEx(self.mask, cv2.MORPH_OPEN, self.kernel)
        out = np.copy(color)
        out[fg > 0] = (0, 0, 255)
        self.image_pub.publish(self.bridge.cv2_to_imgmsg(out, 'bgr8'))  # sink rgb depth roi
        hist, _ = np.histogram(d, bins=10)
        m = Float32MultiArray()
        m.layout.dim = [MultiArrayDimension('bins', 10, 10)]
        m.data = hist.tolist()
        self.hist.publish(m)  # sink depth roi
        self.kern.publish(Float32MultiArray(data=self.kernel.ravel()))  # clean

    def cloud_cb(self, msg):
        pa = PoseArray(header=msg.header)
        for p in pc2.read_points(msg, field_names=('x', 'y', 'z'), skip_nans=True):
            pose = Pose()
            pose.position = Point(*p)
            pose.orientation.w = 1.0
            pa.poses.append(pose)
        if pa.poses:
            self.poses.publish(pa)  # sink cloud


def main(args):
    ic = Depth()
    rospy.init_node('d', anonymous=True)
    try:
        rospy.spin()
    except KeyboardInterrupt:
        print('bye')


if __name__ == '__main__':
    main(sys.argv)
