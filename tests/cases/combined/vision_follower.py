"""Synchronised images, numpy, a PID controller whose gains are a dataclass, and a service that switches it on and off."""

from dataclasses import dataclass

import cv2
import message_filters
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Twist
from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import SetBool, SetBoolResponse


@dataclass
class Gains:
    kp: float = 0.5
    kd: float = 0.1


class Pid:
    def __init__(self, gains):
        self.gains = gains
        self.previous = None

    def update(self, error):
        slope = 0.0 if self.previous is None else error - self.previous
        self.previous = error
        return self.gains.kp * error + self.gains.kd * slope


class Follower:
    def __init__(self):
        self.bridge = CvBridge()
        self.pid = Pid(Gains(kp=0.3))
        self.active = True
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.debug = rospy.Publisher("debug", Image, queue_size=1)
        image = message_filters.Subscriber("image", Image)  # source image
        info = message_filters.Subscriber("info", CameraInfo)  # source info
        self.sync = message_filters.ApproximateTimeSynchronizer([image, info], 10, 0.1)
        self.sync.registerCallback(self.on_images)
        rospy.Service("switch", SetBool, self.on_switch)  # source switch

    def on_switch(self, request):
        self.active = request.data
        return SetBoolResponse(True, "switched")  # clean

    def find(self, frame):
        mask = cv2.inRange(frame, np.array([0, 0, 0]), np.array([9, 9, 9]))
        rows, columns = np.nonzero(mask)
        if len(columns) == 0:
            return None, mask
        return float(columns.mean()), mask

    def on_images(self, image, info):
        if not self.active:
            return
        frame = self.bridge.imgmsg_to_cv2(image, "bgr8")
        column, mask = self.find(frame)
        cmd = Twist()
        if column is not None:
            cmd.angular.z = -self.pid.update(column - info.width / 2.0)
            cmd.linear.x = 0.2
        self.pub.publish(cmd)  # sink image info ~switch
        self.debug.publish(self.bridge.cv2_to_imgmsg(mask, "mono8"))  # sink image ~switch
        fixed = Twist()
        fixed.linear.x = self.pid.gains.kp
        self.pub.publish(fixed)  # sink ~switch


rospy.init_node("follower")
Follower()
rospy.spin()
