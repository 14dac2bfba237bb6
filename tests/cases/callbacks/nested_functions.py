import rospy
from std_msgs.msg import Float64


def make_callback(store, key, gain=1.0):
    def callback(msg):
        store[key] = gain * msg.data

    return callback


def run(topic, pub):
    values = {"x": 0.0, "limit": 1.0}

    def local(msg):
        values["local"] = msg.data

    rospy.Subscriber(topic, Float64, make_callback(values, "x", gain=2.0))  # source x
    rospy.Subscriber("local", Float64, local)  # source local
    while not rospy.is_shutdown():
        pub.publish(values["x"])  # sink x
        pub.publish(values["limit"])  # clean
        pub.publish(values["local"])  # sink local
        rospy.sleep(0.1)


if __name__ == "__main__":
    rospy.init_node("nested")
    run("x", rospy.Publisher("out", Float64, queue_size=1))
