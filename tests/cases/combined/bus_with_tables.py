import rospy
from std_msgs.msg import Float64, Bool, String
from geometry_msgs.msg import Twist

TOPICS = {
    "in": {"speed": ("/speed", Float64), "stop": ("/stop", Bool)},
    "out": {"cmd": ("/cmd_vel", Twist), "log": ("/log", String)},
}


class Bus:
    """Thin wrapper that owns every publisher and subscriber."""

    def __init__(self, table):
        self._table = table
        self._pubs = {}
        self._subs = []
        self._latest = {}

    def open(self):
        for key, (topic, kind) in self._table["out"].items():
            self._pubs[key] = rospy.Publisher(topic, kind, queue_size=1)
        return self

    def on(self, key, callback, keep=False):
        topic, kind = self._table["in"][key]

        def wrapped(msg):
            if keep:
                self._latest[key] = msg
            callback(msg)

        self._subs.append(rospy.Subscriber(topic, kind, wrapped))

    def latest(self, key):
        return self._latest.get(key)

    def emit(self, key, msg):
        pub = self._pubs.get(key)
        if pub is None:
            raise KeyError(key)
        pub.publish(msg)  # sink speed ~stop


class App:
    def __init__(self):
        self.bus = Bus(TOPICS).open()
        self.stopped = False
        self.alive = rospy.Publisher("/alive", Bool, queue_size=1)
        self.bus.on("speed", self.on_speed, keep=True)  # source speed
        self.bus.on("stop", self.on_stop)  # source stop

    def on_stop(self, msg):
        self.stopped = msg.data

    def on_speed(self, msg):
        cmd = Twist()
        self.alive.publish(True)  # clean
        if not self.stopped:
            cmd.linear.x = msg.data
        self.bus.emit("cmd", cmd)
        self.bus.emit("log", String("moving"))


def main():
    rospy.init_node("app")
    app = App()
    rospy.spin()


if __name__ == "__main__":
    main()
