import rospy
from std_msgs.msg import Float64, Float64MultiArray


class Lists:
    def __init__(self):
        self.appended = []
        self.extended = []
        self.inserted = []
        self.added = []
        self.fixed = []
        self.popped = []
        self.slices = [0.0] * 4
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64MultiArray, self.on_in)  # source array
        rospy.Subscriber("one", Float64, self.on_one)  # source one
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_in(self, msg):
        self.extended.extend(msg.data)
        self.added += msg.data
        self.slices[1:3] = msg.data
        self.fixed.extend([1.0, 2.0])

    def on_one(self, msg):
        self.appended.append(msg.data)
        self.inserted.insert(0, msg.data)
        self.popped.append((msg.data, 3.0))
        if len(self.appended) > 10:
            self.appended.pop(0)

    def tick(self, event):
        self.pub.publish(self.appended[-1])  # sink one
        self.pub.publish(self.inserted[0])  # sink one
        self.pub.publish(self.extended[0])  # sink array
        self.pub.publish(self.added[0])  # sink array
        self.pub.publish(self.slices[2])  # sink array
        self.pub.publish(max(self.fixed))  # clean
        value, weight = self.popped.pop()
        self.pub.publish(value)  # sink one
        self.pub.publish(weight)  # clean
        self.pub.publish(sorted(self.inserted)[0])  # sink one
        first, *others = self.extended
        self.pub.publish(others[0])  # sink array


rospy.init_node("lists")
Lists()
rospy.spin()
