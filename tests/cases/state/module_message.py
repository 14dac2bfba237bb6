import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

rospy.init_node("avoid")
cmd = Twist()
cmd.linear.x = 0.2
label = String()
pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
text = rospy.Publisher("/label", String, queue_size=1)


def callback(scan):
    cmd.angular.z = 1.0 / scan.ranges[0]


def name_callback(msg):
    label = msg
    rospy.loginfo(label.data)


rospy.Subscriber("/scan", LaserScan, callback)  # source scan
rospy.Subscriber("/name", String, name_callback)  # source name
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    pub.publish(cmd)  # sink scan
    text.publish(label)  # clean
    back = Twist()
    back.linear.x = cmd.linear.x
    pub.publish(back)  # clean
    rate.sleep()
