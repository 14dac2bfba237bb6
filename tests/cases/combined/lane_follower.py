#!/usr/bin/env python3
import cv2
import numpy as np
import rclpy
from rclpy.node import Node
from cv_bridge import CvBridge
from sensor_msgs.msg import Image, CompressedImage
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32


class LaneFollower(Node):
    def __init__(self):
        super().__init__('lane_follower')
        self.declare_parameters('', [('kp', 0.01), ('speed', 0.2)])
        self.kp = self.get_parameter('kp').get_parameter_value().double_value
        self.bridge = CvBridge()
        self.left_fit = self.right_fit = None
        self.hist = []
        self.image_sub = self.create_subscription(CompressedImage, 'image/compressed', self.image_callback, 1)  # source img
        self.cmd_pub = self.create_publisher(Twist, 'cmd_vel', 1)
        self.err_pub = self.create_publisher(Float32, 'error', 1)
        self.out_pub = self.create_publisher(Image, 'overlay', 1)
        self.const_pub = self.create_publisher(Float32, 'speed', 1)

    def image_callback(self, msg):
        self.const_pub.publish(Float32(data=self.kp))  # clean
        arr = np.frombuffer(msg.data, np.uint8)
        img = cv2.imdecode(arr, cv2.IMREAD_COLOR)
        h, w = img.shape[:2]
        roi = np.zeros_like(img)
        cv2.fillPoly(roi, np.array([[(0, h), (w, h), (w // 2, h // 2)]]), (255, 255, 255))
        masked = cv2.bitwise_and(img, roi)
        edges = cv2.Canny(masked, 50, 150)
        lines = cv2.HoughLinesP(edges, 1, np.pi / 180, 50, minLineLength=40, maxLineGap=5)
        left, right = self.split(lines)
        if left is not None:
            self.left_fit = left
        if right is not None:
            self.right_fit = right
        if self.left_fit is None or self.right_fit is None:
            return
        error = self.center(h, w)
        self.hist.append(error)
        if len(self.hist) > 5:
            self.hist.pop(0)
        smooth = np.average(self.hist, weights=range(1, len(self.hist) + 1))
        self.err_pub.publish(Float32(data=float(smooth)))  # sink img
        twist = Twist()
        twist.linear.x = self.get_parameter('speed').value
        twist.angular.z = float(np.clip(-self.kp * smooth, -1.0, 1.0))
        self.cmd_pub.publish(twist)  # sink img
        overlay = img.copy()
        cv2.line(overlay, (int(w / 2), h), (int(w / 2 + error), h // 2), (0, 0, 255), 3)
        out = self.bridge.cv2_to_imgmsg(overlay, encoding='bgr8')
        out.header = msg.header
        self.out_pub.publish(out)  # sink img
        self.const_pub.publish(Float32(data=twist.linear.x))  # sink ~img

    def split(self, lines):
        left, right = [], []
        if lines is None:
            return None, None
        for x1, y1, x2, y2 in lines.reshape(-1, 4):
            if x1 == x2:
                continue
            slope, icpt = np.polyfit((x1, x2), (y1, y2), 1)
            (left if slope < 0 else right).append((slope, icpt))
        return (np.mean(left, axis=0) if left else None, np.mean(right, axis=0) if right else None)

    def center(self, h, w):
        xs = []
        for fit in (self.left_fit, self.right_fit):
            slope, icpt = fit
            xs.append((h - icpt) / slope)
        return sum(xs) / 2 - w / 2


def main(args=None):
    rclpy.init(args=args)
    node = LaneFollower()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
