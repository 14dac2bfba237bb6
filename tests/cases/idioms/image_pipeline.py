"""cv_bridge and OpenCV: masks, contours, drawing in place, moments, a PID on the centroid."""

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Twist
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Bool, Float32, Int32


class Tracker:
    def __init__(self):
        self.bridge = CvBridge()
        self.lower = np.array([20, 100, 100])
        self.upper = np.array([30, 255, 255])
        self.integral = 0.0
        self.last = None
        self.debug = rospy.Publisher("debug", Image, queue_size=1)
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.seen = rospy.Publisher("seen", Bool, queue_size=1)
        self.area = rospy.Publisher("area", Float32, queue_size=1)
        self.count = rospy.Publisher("count", Int32, queue_size=1)
        self.jpeg = rospy.Publisher("debug/compressed", CompressedImage, queue_size=1)
        self.blank = rospy.Publisher("blank", Image, queue_size=1)
        rospy.Subscriber("image", Image, self.on_image, queue_size=1, buff_size=2**24)  # source image
        rospy.Subscriber("lower", Int32, self.on_lower)  # source lower

    def on_lower(self, msg):
        self.lower[0] = msg.data

    def on_image(self, msg):
        try:
            frame = self.bridge.imgmsg_to_cv2(msg, desired_encoding="bgr8")
        except CvBridgeError as error:
            rospy.logerr(error)
            return
        hsv = cv2.cvtColor(cv2.GaussianBlur(frame, (5, 5), 0), cv2.COLOR_BGR2HSV)
        mask = cv2.inRange(hsv, self.lower, self.upper)
        mask = cv2.erode(mask, None, iterations=2)
        contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[-2:]
        self.count.publish(len(contours))  # sink image lower
        twist = Twist()
        if contours:
            largest = max(contours, key=cv2.contourArea)
            (x, y), radius = cv2.minEnclosingCircle(largest)
            cv2.circle(frame, (int(x), int(y)), int(radius), (0, 255, 0), 2)
            self.area.publish(cv2.contourArea(largest))  # sink image lower
            error = frame.shape[1] / 2 - x
            self.integral = np.clip(self.integral + error, -100, 100)
            derivative = 0.0 if self.last is None else error - self.last
            self.last = error
            twist.angular.z = 0.005 * error + 0.0001 * self.integral + 0.001 * derivative
            self.seen.publish(True)  # sink ~image ~lower
        else:
            twist.angular.z = 0.3
            self.seen.publish(False)  # sink ~image ~lower
        self.cmd.publish(twist)  # sink image lower
        out = self.bridge.cv2_to_imgmsg(frame, "bgr8")
        out.header = msg.header
        self.debug.publish(out)  # sink image lower
        packed = CompressedImage(format="jpeg")
        packed.data = cv2.imencode(".jpg", mask)[1].tobytes()
        self.jpeg.publish(packed)  # sink image lower
        canvas = np.zeros((480, 640, 3), np.uint8)
        cv2.putText(canvas, "no signal", (10, 200), cv2.FONT_HERSHEY_SIMPLEX, 1, (255, 255, 255))
        self.blank.publish(self.bridge.cv2_to_imgmsg(canvas, "bgr8"))  # clean


if __name__ == "__main__":
    rospy.init_node("tracker")
    Tracker()
    rospy.spin()
