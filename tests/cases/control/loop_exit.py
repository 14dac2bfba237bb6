import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

x = 0.0


def on_odom(msg):
    global x
    x = msg.pose.pose.position.x


def drive(goal):
    rate = rospy.Rate(10)
    while x < goal:
        pub.publish(0.2)  # sink ~odom
        rate.sleep()
    pub.publish(0.0)  # clean


def search():
    found = False
    for angle in (0.1, 0.2, 0.3):
        if x > angle:
            found = True
            break
    pub.publish(angle)  # sink ~odom
    pub.publish(1.0 if found else 2.0)  # sink ~odom
    for angle in (0.1, 0.2):
        if x > angle:
            continue
        pub.publish(3.0)  # sink ~odom
    while not rospy.is_shutdown():
        if x > 5.0:
            break
        pub.publish(4.0)  # sink ~odom
    else:
        pub.publish(5.0)  # sink ~odom
    count = 0
    while x < 9.0:
        count += 1
        rospy.sleep(0.1)
    pub.publish(count)  # sink ~odom
    for _ in range(3):
        pub.publish(6.0)  # clean


rospy.init_node("loops")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("odom", Odometry, on_odom)  # source odom
drive(10.0)
search()
