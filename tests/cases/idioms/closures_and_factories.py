"""A script in functions: factories of callbacks, `nonlocal` state, and a filter that closes over its memory."""

import rospy
from geometry_msgs.msg import Vector3Stamped
from sensor_msgs.msg import Imu
from std_msgs.msg import Float64


def low_pass(alpha):
    value = None

    def step(sample):
        nonlocal value
        value = sample if value is None else alpha * sample + (1.0 - alpha) * value
        return value

    return step


def counter():
    n = 0

    def count():
        nonlocal n
        n += 1
        return n

    return count


def make_callback(axis, publisher, smooth):
    def callback(msg):
        publisher.publish(smooth(getattr(msg.linear_acceleration, axis)))  # sink imu

    return callback


def main():
    rospy.init_node("smoother")
    tick = counter()
    bias = 0.0
    count_pub = rospy.Publisher("count", Float64, queue_size=1)
    vec_pub = rospy.Publisher("bias", Vector3Stamped, queue_size=1)

    def on_bias(msg):
        nonlocal bias
        bias = msg.data

    def on_timer(event):
        out = Vector3Stamped()
        out.header.stamp = event.current_real
        out.vector.x = bias
        vec_pub.publish(out)  # sink bias
        count_pub.publish(tick())  # clean

    for axis in "xyz":
        pub = rospy.Publisher("smooth_" + axis, Float64, queue_size=5)
        rospy.Subscriber("imu", Imu, make_callback(axis, pub, low_pass(0.1)))  # source imu
    rospy.Subscriber("bias_in", Float64, on_bias)  # source bias
    rospy.Timer(rospy.Duration(0.5), on_timer)
    rospy.spin()


if __name__ == "__main__":
    main()
