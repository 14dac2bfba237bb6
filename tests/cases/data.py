import collections
import copy

import numpy as np
import rospy
from cv_bridge import CvBridge
from std_msgs.msg import Float64, Float64MultiArray

bridge = CvBridge()
queue = collections.deque(maxlen=5)
grid = np.zeros((4, 4))
names = ["a", "b"]


def on_input(msg):
    first, *rest = msg.data
    pub.publish(first)  # sink in
    pub.publish(rest[0])  # sink in
    pair = (msg.layout, 2.0)
    pub.publish(pair[0])  # sink in
    pub.publish(pair[1])  # clean
    squares = [x * x for x in msg.data if x > 0.0]
    pub.publish(max(squares))  # sink in
    table = {name: msg.data[i] for i, name in enumerate(names)}
    pub.publish(table["a"])  # sink in
    total = 0.0
    total += msg.data[0]
    pub.publish(total)  # sink in
    queue.append(msg.data[1])
    grid[0, 1] = msg.data[2]
    out = Float64MultiArray()
    out.data.append(msg.data[0])
    array.publish(out)  # sink in
    image = bridge.imgmsg_to_cv2(msg, "bgr8")
    blurred = np.mean(image, axis=0)
    pub.publish(blurred)  # sink in
    text = "%s and %d" % (msg.data[0], 3)
    pub.publish(f"{text}!")  # sink in
    twin = copy.deepcopy(msg)
    array.publish(twin)  # sink in
    twin.data = []
    pub.publish(twin.data)  # clean
    if (n := len(msg.data)) > 3:
        pub.publish(n)  # sink in
    pub.publish(lookup[int(msg.data[0])])  # sink in
    fresh = Float64MultiArray(data=[1.0])
    array.publish(fresh)  # clean
    match msg.data[0]:
        case 1.0:
            pub.publish(1.5)  # sink ~in
        case other:
            pub.publish(other)  # sink in


def tick(event):
    pub.publish(queue[0])  # sink in
    array.publish(grid)  # sink in
    pub.publish(names[0])  # clean


lookup = [0.1, 0.2, 0.3]
prefix = "robot"
pub = rospy.Publisher("out", Float64, queue_size=1)
array = rospy.Publisher(prefix + "/array", Float64MultiArray, queue_size=1)
rospy.Subscriber("/{}/in".format(prefix), Float64MultiArray, on_input)  # source in
rospy.Timer(rospy.Duration(1.0), tick)
rospy.spin()
