import rospy
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64, Float64MultiArray
from tf.transformations import euler_from_quaternion

x = y = theta = 0.0
first = last = middle = None
pair = (0.0, 0.0)


def on_pose(msg):
    global x, y, theta
    x, y = msg.pose.position.x, 0.0
    q = msg.pose.orientation
    _, _, theta = euler_from_quaternion([q.x, q.y, q.z, q.w])


def on_array(msg):
    global first, last, middle, pair
    first, *middle, last = msg.data
    pair = swap(msg.data[0], 1.0)


def swap(a, b):
    return b, a


def main():
    rospy.init_node("unpack")
    rospy.Subscriber("pose", PoseStamped, on_pose)  # source pose
    rospy.Subscriber("array", Float64MultiArray, on_array)  # source array
    pub = rospy.Publisher("out", Float64, queue_size=1)
    while not rospy.is_shutdown():
        pub.publish(x)  # sink pose
        pub.publish(y)  # clean
        pub.publish(theta)  # sink pose
        pub.publish(first)  # sink array
        pub.publish(last)  # sink array
        pub.publish(middle[0])  # sink array
        one, other = pair
        pub.publish(one)  # clean
        pub.publish(other)  # sink array
        rospy.sleep(0.1)


main()
