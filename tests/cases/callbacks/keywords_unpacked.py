import rospy
from std_msgs.msg import Float64


class Relay:
    def __init__(self):
        self.y = self.z = 0.0
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.other = rospy.Publisher("other", Float64, queue_size=1)
        options = {"callback": self.on_in, "queue_size": 1}
        rospy.Subscriber("in", Float64, **options)  # source in
        timing = dict(period=rospy.Duration(1.0), callback=self.on_timer, oneshot=False)
        if rospy.get_param("use_sim_time", None):
            timing["reset"] = True
        rospy.Timer(**timing)

    def on_in(self, msg):
        self.y = msg.data

    def on_timer(self, event):
        self.pub.publish(self.y)  # sink in
        self.other.publish(self.z)  # clean


Relay()
rospy.spin()
