import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64, String

from . import control, state
from .control import Pid, clamp
from .control import join_names as names

forward = Pid(0.5)
sideways = Pid(0.5)


def on_odom(msg):
    pub.publish(clamp(msg.pose.pose.position.x))  # sink odom
    pub.publish(clamp(3.0, limit=2.0))  # clean
    pub.publish(control.heading(msg.pose.pose))  # sink odom
    pub.publish(forward(msg.pose.pose.position.x))  # sink odom
    pub.publish(sideways(0.1))  # clean
    state.remember("x", msg.pose.pose.position.x)
    state.remember("fixed", 1.0)


def tick(event):
    pub.publish(state.recall("x"))  # sink odom
    pub.publish(state.recall("fixed"))  # clean
    pub.publish(state.latest["x"])  # sink odom
    pub.publish(state.count)  # clean
    text.publish(names("a", "b"))  # clean
    text.publish(names("a", str(state.recall("x"))))  # sink odom


rospy.init_node("helpers")
pub = rospy.Publisher("out", Float64, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
rospy.Subscriber("odom", Odometry, on_odom)  # source odom
rospy.Timer(rospy.Duration(1), tick)
rospy.spin()
