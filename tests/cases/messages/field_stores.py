import rospy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

rospy.init_node("fields")
twists = rospy.Publisher("cmd_vel", Twist, queue_size=1)
poses = rospy.Publisher("goal", PoseStamped, queue_size=1)
numbers = rospy.Publisher("number", Float64, queue_size=1)


def on_odom(msg):
    number = Float64()
    number.data = msg.pose.pose.position.x
    numbers.publish(number)  # sink odom
    number = Float64()
    number.data = 1.0
    numbers.publish(number)  # clean
    cmd = Twist()
    cmd.linear.x = msg.twist.twist.linear.x
    cmd.angular.z = 0.3
    twists.publish(cmd)  # sink odom
    numbers.publish(cmd.angular.z)  # clean
    numbers.publish(cmd.linear.y)  # clean
    goal = PoseStamped()
    goal.header.frame_id = "odom"
    goal.pose.position.x = 1.0
    goal.pose.orientation = msg.pose.pose.orientation
    poses.publish(goal)  # sink odom
    numbers.publish(goal.pose.orientation.w)  # sink odom
    numbers.publish(goal.pose.position.x)  # clean
    linear = cmd.linear
    linear.x = 0.0
    twists.publish(cmd)  # clean
    goal.pose = PoseStamped().pose
    poses.publish(goal)  # clean


rospy.Subscriber("odom", Odometry, on_odom)  # source odom
rospy.spin()
