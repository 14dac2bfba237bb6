import rospy
from std_msgs.msg import Float64, String


def listen(topic, kind, callback, *args):
    rospy.loginfo("listening to %s", topic)
    return rospy.Subscriber(topic, kind, callback, *args)


class Hub:
    def __init__(self):
        self.subs = []
        self.last = 0.0
        self.text = ""
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.names = rospy.Publisher("names", String, queue_size=1)
        self.add("level", Float64, self.on_level)  # source level
        self.add("name", String, self.on_name)  # source name
        listen("direct", Float64, on_direct, self.pub)  # source direct

    def add(self, topic, kind, callback):
        self.subs.append(rospy.Subscriber(topic, kind, callback, queue_size=5))

    def on_level(self, msg):
        self.last = msg.data

    def on_name(self, msg):
        self.text = msg.data

    def run(self):
        while not rospy.is_shutdown():
            self.pub.publish(self.last)  # sink level
            self.names.publish(self.text)  # sink name
            self.names.publish("fixed")  # clean
            rospy.sleep(1)


def on_direct(msg, pub):
    pub.publish(msg.data)  # sink direct


rospy.init_node("hub")
Hub().run()
