import copy
import sys
from contextlib import suppress, ExitStack
from itertools import chain, cycle, count
from operator import itemgetter, attrgetter, methodcaller
from types import SimpleNamespace
import rospy
from geometry_msgs.msg import Twist, Point, Quaternion, Vector3, PoseStamped
from std_msgs.msg import Float64, ColorRGBA, Header, String
from visualization_msgs.msg import Marker, MarkerArray
from sensor_msgs.msg import Imu, JointState


class Odd:
    def __init__(self):
        self.ns = SimpleNamespace(x=0.0, y=1.0)
        self.pub = rospy.Publisher("p", Float64, queue_size=1)
        self.tw = rospy.Publisher("t", Twist, queue_size=1)
        self.mk = rospy.Publisher("m", MarkerArray, queue_size=1)
        self.js = rospy.Publisher("j", JointState, queue_size=1)
        self.txt = rospy.Publisher("s", String, queue_size=1)
        self.colors = cycle(["red", "blue"])
        self.ids = count()
        self.trail = []
        rospy.Subscriber("imu", Imu, self.cb)  # source imu
        rospy.Subscriber("pose", PoseStamped, self.on_pose, callback_args=(3, "x"))  # source pose
        rospy.Subscriber("twist", Twist, self.relay)  # source twist

    def relay(self, msg):
        out = Twist()
        for slot in msg.__slots__:
            setattr(out, slot, getattr(msg, slot))
        self.tw.publish(out)  # sink twist
        half = copy.deepcopy(msg)
        half.linear = Vector3(*[0.5 * getattr(msg.linear, a) for a in "xyz"])
        half.angular = Vector3()
        self.tw.publish(half)  # sink twist

    def cb(self, m):
        self.ns.x = m.linear_acceleration.x
        get = attrgetter("angular_velocity.z")
        self.pub.publish(get(m))  # sink imu
        self.pub.publish(self.ns.x)  # sink imu
        self.pub.publish(self.ns.y)  # clean
        pairs = {"a": m.linear_acceleration.x, "b": 2.0}
        self.pub.publish(itemgetter("a")(pairs))  # sink imu
        with suppress(ValueError):
            self.pub.publish(float(m.header.frame_id))  # sink imu
        first, *middle, last = m.orientation_covariance
        self.pub.publish(last)  # sink imu
        self.pub.publish(sum(chain([1.0], [2.0])))  # clean
        a = b = m.linear_acceleration.y
        a, b = 0.0, a
        self.pub.publish(a)  # clean
        self.pub.publish(b)  # sink imu
        x = 1.0 if True else m.linear_acceleration.x
        self.pub.publish(x)  # clean
        del self.ns.x
        self.txt.publish("got %d from %s" % (next(self.ids), next(self.colors)))  # clean

    def on_pose(self, msg, args):
        number, name = args
        self.trail.append(msg.pose.position)
        arr = MarkerArray()
        for i, p in enumerate(self.trail):
            mk = Marker(header=Header(frame_id="map", stamp=rospy.Time.now()), id=i, type=Marker.SPHERE)
            mk.pose.position = p
            mk.scale.x = mk.scale.y = 0.1
            mk.color = ColorRGBA(*(1.0, 0.0, 0.0, 1.0))
            arr.markers.append(mk)
        self.mk.publish(arr)  # sink pose
        js = JointState()
        js.name = [name]
        js.position = [number]
        self.js.publish(js)  # clean
        js.position += [msg.pose.position.z]
        self.js.publish(js)  # sink pose
        js.position[:] = []
        self.js.publish(js)  # clean
        self.txt.publish("%s: %s" % (name, number))  # clean
        self.txt.publish(repr(msg.pose.position))  # sink pose


rospy.init_node("o")
Odd()
rospy.spin()
