import rclpy
from geometry_msgs.msg import Point, Twist, Vector3
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float32, Float64, Int8, String

rclpy.init()
say(Float64(), Float64(data=1.5), Bool(), String(data="a"))
say(Twist())
say(Point(x=1.0) == Point(x=1.0), Point() == Vector3(), Float32(data=0.1).data)
say(Twist.get_fields_and_field_types(), type(LaserScan().ranges).__name__, Twist.__slots__)
scan = LaserScan(ranges=[1.0, 2.5])
say(type(scan.ranges).__name__, list(scan.ranges))
for action in (
    lambda: Float64(data=1),
    lambda: Float64(data="x"),
    lambda: Int8(data=200),
    lambda: Int8(data=1.0),
    lambda: String(data=3),
    lambda: Point(w=1.0),
    lambda: setattr(Point(), "w", 1.0),
    lambda: setattr(Point(), "x", 1),
    lambda: Point(1.0),
    lambda: setattr(Twist(), "linear", Point()),
    lambda: LaserScan(ranges=["x"]),
):
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__)
