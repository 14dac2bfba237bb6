import rospy
from std_msgs.msg import Float64, Bool, String, Int32
from sensor_msgs.msg import LaserScan

LEVELS = {"low": 0.1, "mid": 0.5, "high": 1.0}


class Abort(Exception):
    pass


class Sel:
    def __init__(self):
        self.level = "low"
        self.tries = 0
        self.armed = False
        self.names = ("a", "b", "c")
        self.pub = rospy.Publisher("p", Float64, queue_size=1)
        self.s = rospy.Publisher("s", String, queue_size=1)
        self.n = rospy.Publisher("n", Int32, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("arm", Bool, self.on_arm)  # source arm
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_arm(self, m):
        self.armed = m.data

    def on_scan(self, m):
        near = min(m.ranges)
        if near < 0.2:
            self.level = "low"
        elif near < 1.0:
            self.level = "mid"
        else:
            self.level = "high"

    def guard(self):
        if not self.armed:
            raise Abort()
        return 2

    def tick(self, _):
        self.tries += 1
        self.pub.publish(LEVELS[self.level])  # sink ~scan
        self.pub.publish(LEVELS["low"])  # clean
        try:
            k = self.guard()
            self.n.publish(k)  # sink ~arm
        except Abort:
            self.n.publish(0)  # sink ~arm
        finally:
            self.n.publish(9)  # clean
        self.n.publish(self.tries)  # clean
        ok = self.armed and self.level == "high"
        self.n.publish(1 if ok else 0)  # sink ~arm ~scan
        for name in self.names:
            if name == self.level:
                break
        else:
            self.s.publish("none")  # sink ~scan
        self.s.publish("end")  # clean
        while not self.armed:
            rospy.sleep(0.1)
        self.s.publish("armed")  # clean
        assert self.level != "low", "too near"
        self.s.publish("assured")  # sink ~scan
        self.helper(self.level)

    def helper(self, level):
        if level == "mid":
            return
        self.s.publish("not mid")  # sink ~scan
        self.sub()

    def sub(self):
        self.s.publish("sub")  # sink ~scan


rospy.init_node("s")
Sel()
rospy.spin()
