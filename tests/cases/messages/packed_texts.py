import json
import struct
import rospy
from std_msgs.msg import String, UInt8MultiArray, Int32, Float32
from collections import namedtuple

Telemetry = namedtuple("Telemetry", "speed heading voltage")


class Bridge:
    def __init__(self):
        self.raw = rospy.Publisher("raw", UInt8MultiArray, queue_size=1)
        self.js = rospy.Publisher("json", String, queue_size=1)
        self.fm = rospy.Publisher("fmt", String, queue_size=1)
        self.v = rospy.Publisher("voltage", Float32, queue_size=1)
        self.h = rospy.Publisher("heading", Float32, queue_size=1)
        self.t = Telemetry(0.0, 0.0, 12.0)
        rospy.Subscriber("speed", Float32, self.on_speed)  # source speed
        rospy.Subscriber("cmd", String, self.on_command)  # source cmd

    def on_speed(self, msg):
        self.t = self.t._replace(speed=msg.data)
        self.v.publish(self.t.voltage)  # clean
        packet = struct.pack("<fB", self.t.speed, 3)
        self.raw.publish(UInt8MultiArray(data=list(packet)))  # sink speed
        self.js.publish(json.dumps({"speed": self.t.speed, "v": self.t.voltage}))  # sink speed
        self.fm.publish(f"{self.t.speed:.2f} m/s")  # sink speed
        self.fm.publish("{0} at {1}".format("n", self.t.voltage))  # clean

    def on_command(self, msg):
        try:
            doc = json.loads(msg.data)
        except ValueError:
            return
        kind, *rest = msg.data.split(",")
        if kind == "heading" and rest:
            self.h.publish(float(rest[0]))  # sink cmd
        elif doc.get("stop"):
            self.h.publish(0.0)  # sink ~cmd
        self.fm.publish(" ".join(reversed(rest)).upper())  # sink cmd
        self.fm.publish(String("%s" % doc["id"]))  # sink cmd


rospy.init_node("bridge")
b = Bridge()
rospy.spin()
