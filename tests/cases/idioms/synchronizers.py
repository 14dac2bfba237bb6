"""message_filters: exact and approximate time, a cache, callbacks with extra arguments, and star arguments."""

import message_filters
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import CameraInfo, Image, Imu
from std_msgs.msg import Float64


class Sync:
    def __init__(self):
        self.bridge = CvBridge()
        self.point = rospy.Publisher("point", PointStamped, queue_size=1)
        self.skew = rospy.Publisher("skew", Float64, queue_size=1)
        self.turn = rospy.Publisher("turn", Float64, queue_size=1)
        self.ratio = rospy.Publisher("ratio", Float64, queue_size=1)
        color = message_filters.Subscriber("color", Image)  # source color
        depth = message_filters.Subscriber("depth", Image)  # source depth
        info = message_filters.Subscriber("info", CameraInfo)  # source info
        self.sync = message_filters.ApproximateTimeSynchronizer([color, depth, info], 10, 0.05)
        self.sync.registerCallback(self.on_all)
        pair = message_filters.TimeSynchronizer([depth, info], 5)
        pair.registerCallback(self.on_pair, 2.0)
        self.imu = message_filters.Cache(message_filters.Subscriber("imu", Imu), 50)  # source imu
        any_of = message_filters.TimeSynchronizer([color, info], 5)
        any_of.registerCallback(lambda *messages: self.skew.publish(messages[0].header.stamp.to_sec()))  # sink color

    def on_all(self, color, depth, info):
        image = self.bridge.imgmsg_to_cv2(depth, "passthrough")
        u, v = info.width // 2, info.height // 2
        out = PointStamped()
        out.header.stamp = color.header.stamp
        out.point.z = float(image[v, u])
        out.point.x = (u - info.K[2]) * out.point.z / info.K[0]
        self.point.publish(out)  # sink color depth info
        nearest = self.imu.getElemBeforeTime(color.header.stamp)
        if nearest is not None:
            self.turn.publish(nearest.angular_velocity.z)  # sink imu color

    def on_pair(self, depth, info, factor):
        self.ratio.publish(depth.width / info.width * factor)  # sink depth info
        self.ratio.publish(factor)  # clean


if __name__ == "__main__":
    rospy.init_node("sync")
    Sync()
    rospy.spin()
