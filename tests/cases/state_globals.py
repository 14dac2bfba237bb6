import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64, String

speed = 0.0
shared = Twist()
stamp = None


def on_speed(msg):
    global speed, stamp
    speed = msg.data
    stamp = rospy.Time.now()


def on_odom(msg):
    shared.linear.x = msg.twist.twist.linear.x
    shared.angular.z = 0.3


def tick(event):
    pub.publish(speed)  # sink speed
    pub.publish(shared.linear.x)  # sink odom
    pub.publish(shared.angular.z)  # clean
    pub.publish(shared.linear.y)  # clean
    if stamp is not None:
        pub.publish(1.0)  # clean
    whole.publish(shared)  # sink odom
    shared.linear.x = 0.0
    whole.publish(shared)  # clean


def shadow(event):
    speed = 2.0
    pub.publish(speed)  # clean


pub = rospy.Publisher("out", Float64, queue_size=1)
whole = rospy.Publisher("whole", Twist, queue_size=1)
rospy.Subscriber("speed", Float64, on_speed)  # source speed
rospy.Subscriber("odom", Odometry, on_odom)  # source odom
rospy.Subscriber("unused", String, lambda msg: rospy.loginfo(msg.data))  # source unused
rospy.Timer(rospy.Duration(0.1), tick)
rospy.Timer(rospy.Duration(0.1), shadow)
rospy.spin()
