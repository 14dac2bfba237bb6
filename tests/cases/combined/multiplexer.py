import functools
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import String, Bool

CONFIG = {
    "inputs": [
        {"name": "joy", "topic": "cmd_vel/joy", "priority": 10, "timeout": 0.5},
        {"name": "nav", "topic": "cmd_vel/nav", "priority": 1, "timeout": 1.0},
    ],
    "output": "cmd_vel",
    "lock": {"topic": "e_stop"},
}


class Input:
    def __init__(self, name, topic, priority, timeout):
        self.name, self.priority, self.timeout = name, priority, timeout
        self.msg = None
        self.stamp = rospy.Time(0)
        self.sub = rospy.Subscriber(topic, Twist, self.cb)  # source cmd

    def cb(self, msg):
        self.msg = msg  # step cmd
        self.stamp = rospy.Time.now()

    def fresh(self):
        return self.msg is not None and (rospy.Time.now() - self.stamp).to_sec() < self.timeout


class Mux:
    def __init__(self, cfg):
        self.inputs = [Input(**c) for c in cfg["inputs"]]
        self.pub = rospy.Publisher(cfg["output"], Twist, queue_size=1)
        self.active_pub = rospy.Publisher("mux/active", String, queue_size=1, latch=True)
        self.locked = False
        rospy.Subscriber(cfg["lock"]["topic"], Bool, functools.partial(self.set_flag, "locked"))  # source lock
        rospy.Timer(rospy.Duration(0.05), self.tick)

    def set_flag(self, attr, msg):
        setattr(self, attr, msg.data)  # step ~lock

    def select(self):
        live = filter(Input.fresh, self.inputs)  # step cmd
        live = sorted(live, key=lambda i: -i.priority)  # step cmd
        return live[0] if live else None  # step cmd

    def tick(self, _event):
        self.active_pub.publish("tick")  # clean
        if self.locked:  # step ~lock
            self.pub.publish(Twist())  # sink ~lock
            return
        chosen = self.select()  # step cmd
        if chosen is None:
            return
        self.pub.publish(chosen.msg)  # sink cmd ~lock
        self.active_pub.publish(chosen.name)  # sink ~lock


if __name__ == "__main__":
    rospy.init_node("mux")
    Mux(CONFIG)
    rospy.spin()
