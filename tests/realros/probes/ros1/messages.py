import rospy
from geometry_msgs.msg import Point, Pose, Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, ColorRGBA, Float64, Header, Int8, String, UInt8MultiArray

rospy.init_node("prober")
say(Float64(), Float64(1.5), Bool(), String("a"), Point(1, 2, 3))
say(Twist())
say(Point(x=1), Point() == Point(0, 0, 0), Point() == Vector3(), Float64(1) == Float64(1.0))
say(Twist._type, Twist.__slots__, Twist._slot_types, Float64._md5sum)
say(type(LaserScan().ranges).__name__, len(Odometry().pose.covariance), type(Odometry().pose.covariance).__name__)
say(repr(Header(seq=3, frame_id="map")), type(UInt8MultiArray().data).__name__, ColorRGBA(1, 0, 0, 1))
for action in (lambda: Point(1, 2), lambda: Point(w=1), lambda: Point(1, 2, 3, x=1), lambda: Float64("a"),
               lambda: setattr(Point(), "w", 1), lambda: Pose().position.w, lambda: Int8(data=1, extra=2)):  # fmt: skip
    try:
        say(action())
    except Exception as error:
        said = str(error).partition(" and no __dict__")[0]  # what Python 3.13 adds
        say(type(error).__name__, said)
