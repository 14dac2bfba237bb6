"""A fleet monitor: callbacks made by `functools.partial`, state and publishers by robot name."""

from collections import defaultdict
from functools import partial

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float32, String


class Fleet(object):
    def __init__(self, names):
        self.names = names
        self.positions = {}
        self.counts = defaultdict(int)
        self.alive = dict.fromkeys(names, False)
        self.pubs = {n: rospy.Publisher("/%s/spacing" % n, Float32, queue_size=1) for n in names}
        self.count_pub = rospy.Publisher("/fleet/count", Float32, queue_size=1)
        self.alarm = rospy.Publisher("/fleet/alarm", Bool, queue_size=1)
        self.roster = rospy.Publisher("/fleet/roster", String, latch=True, queue_size=1)
        self.subs = []
        for name in names:
            self.subs.append(rospy.Subscriber("/%s/odom" % name, Odometry, partial(self.on_odom, name)))  # source odom
        rospy.Subscriber("/estop", Bool, partial(self.on_estop, publisher=self.alarm))  # source estop
        rospy.Timer(rospy.Duration(1.0), partial(self.report, verbose=True))
        self.roster.publish(", ".join(sorted(names)))  # clean

    def on_odom(self, name, msg):
        self.positions[name] = msg.pose.pose.position
        self.counts[name] += 1
        self.alive[name] = True

    def on_estop(self, msg, publisher=None):
        publisher.publish(msg.data)  # sink estop

    def report(self, event, verbose=False):
        for name in self.names:
            others = [p for n, p in self.positions.items() if n != name]
            if name not in self.positions or not others:
                continue
            mine = self.positions[name]
            gap = min(((p.x - mine.x) ** 2 + (p.y - mine.y) ** 2) ** 0.5 for p in others)
            self.pubs[name].publish(gap)  # sink odom
        self.count_pub.publish(sum(self.counts.values()))  # clean
        if verbose:
            self.roster.publish(" ".join(n for n in self.names if self.alive[n]))  # clean


if __name__ == "__main__":
    rospy.init_node("fleet")
    Fleet(rospy.get_param("~robots", ["alpha", "beta"]))
    rospy.spin()
