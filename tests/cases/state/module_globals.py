import rospy
from std_msgs.msg import Float64

level = 0.0
readings = {"level": 0.0, "limit": 1.0}
history = []
offset = 0.1


def on_level(msg):
    global level
    level = msg.data


def on_depth(msg):
    readings["level"] = msg.data
    history.append(msg.data)


def on_ignored(msg):
    level = msg.data
    rospy.logdebug("%f", level)


def main():
    rospy.init_node("tank")
    pub = rospy.Publisher("out", Float64, queue_size=1)
    rospy.Subscriber("level", Float64, on_level)  # source level
    rospy.Subscriber("depth", Float64, on_depth)  # source depth
    rospy.Subscriber("ignored", Float64, on_ignored)  # source ignored
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        pub.publish(level)  # sink level
        pub.publish(readings["level"] + offset)  # sink depth
        pub.publish(readings["limit"])  # clean
        pub.publish(offset)  # clean
        if history:
            pub.publish(history[-1])  # sink depth
        rate.sleep()


if __name__ == "__main__":
    main()
