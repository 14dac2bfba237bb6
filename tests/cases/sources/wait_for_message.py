import rospy
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64


def nearest(topic, timeout=None):
    scan = rospy.wait_for_message(topic, LaserScan, timeout)  # source scan
    return min(scan.ranges)


def main():
    rospy.init_node("waiter")
    pub = rospy.Publisher("out", Float64, queue_size=1)
    goal = rospy.wait_for_message("goal", PoseStamped, timeout=5.0)  # source goal
    start = rospy.wait_for_message("start", PoseStamped)  # source start
    rospy.loginfo("start at %f", start.pose.position.x)
    while not rospy.is_shutdown():
        pub.publish(nearest("scan"))  # sink scan
        pub.publish(goal.pose.position.x)  # sink goal
        pub.publish(0.5)  # clean
        try:
            again = rospy.wait_for_message("goal", PoseStamped, timeout=0.1)  # source again
        except rospy.ROSException:
            continue
        pub.publish(again.pose.position.y)  # sink again


if __name__ == "__main__":
    main()
