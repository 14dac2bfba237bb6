import rospy
from geometry_msgs.msg import PointStamped, PoseStamped, Twist
from std_msgs.msg import Float64, Int32, String


class Initializer:
    def __init__(self):
        self.pub = rospy.Publisher("out", PoseStamped, queue_size=1)
        self.number = rospy.Publisher("number", Float64, queue_size=1)
        self.wide = rospy.Publisher("wide", Float64, queue_size=1)
        rospy.Subscriber("pose", PoseStamped, self.on)  # source pose
        rospy.Subscriber("point", PointStamped, self.on)  # source point
        for topic, kind in (("float", Float64), ("int", Int32)):
            rospy.Subscriber(topic, kind, self.on_number)  # source number
        rospy.Subscriber("any", rospy.AnyMsg, self.on_any)  # source any
        rospy.Subscriber("twist", Twist, self.on_base)  # source twist

    def on(self, msg):
        if isinstance(msg, PointStamped):
            self.pub.publish(PoseStamped())  # clean
        elif isinstance(msg, PoseStamped):
            self.pub.publish(msg)  # sink pose
        if isinstance(msg, (Twist, PointStamped)):
            self.pub.publish(msg.point)  # sink point
        else:
            self.pub.publish(msg.pose)  # sink pose
        if not isinstance(msg, (String, Twist)):
            self.pub.publish(msg)  # sink pose point
        kept = msg
        if isinstance(kept, String):
            self.pub.publish(kept)  # clean

    def on_number(self, msg):
        if isinstance(msg, Float64):
            self.number.publish(msg)  # sink number
        if isinstance(msg, Int32):
            self.number.publish(float(msg.data))  # sink number

    def on_any(self, msg):
        if isinstance(msg, Float64):
            self.wide.publish(msg)  # clean

    def on_base(self, msg):
        if isinstance(msg, (rospy.Message, String)):
            self.wide.publish(msg.linear.x)  # sink twist


rospy.init_node("initializer")
Initializer()
rospy.spin()
