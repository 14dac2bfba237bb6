"""Whether a conversion, a parser or a look-up fails on a message decides whether the handler and later code run."""

import json
import math

import rospy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64, String

GAINS = {"slow": 0.2, "fast": 1.0}


class Listener:
    def __init__(self):
        self.buffer = tf2_ros.Buffer()
        self.state = rospy.Publisher("state", String, queue_size=1)
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.mode = "slow"
        self.level = 0.0
        rospy.Subscriber("number", String, self.on_number)  # source number
        rospy.Subscriber("json", String, self.on_json)  # source json
        rospy.Subscriber("pose", PoseStamped, self.on_pose)  # source pose
        rospy.Subscriber("mode", String, self.on_mode)  # source mode
        rospy.Subscriber("name", String, self.on_name)  # source name
        rospy.Subscriber("other", String, self.on_other)  # source other
        rospy.Subscriber("level", Float64, self.on_level)  # source level

    def on_number(self, msg):
        try:
            value = float(msg.data)
        except ValueError:
            self.state.publish("no number")  # sink ~number
            return
        self.state.publish("number")  # sink ~number
        self.out.publish(value)  # sink number

    def parse(self, text):
        fields = json.loads(text)
        return fields["speed"]

    def on_json(self, msg):
        try:
            speed = self.parse(msg.data)
        except Exception:
            self.state.publish("not readable")  # sink ~json
        else:
            self.out.publish(speed)  # sink json
        self.state.publish("done")  # clean

    def on_pose(self, msg):
        try:
            found = self.buffer.lookup_transform("map", msg.header.frame_id, rospy.Time(0))
        except tf2_ros.LookupException:
            self.state.publish("lost")  # sink ~pose
            return
        self.out.publish(found.transform.translation.x)  # sink pose

    def on_mode(self, msg):
        try:
            gain = GAINS[msg.data]
        except KeyError:
            self.state.publish("no such mode")  # sink ~mode
            return
        self.out.publish(gain)  # sink mode

    def on_name(self, msg):
        try:
            int(msg.data)
        except OSError:
            self.state.publish("never by int")  # clean
        try:
            label = "-".join(["a", msg.data])
            rospy.loginfo(label)
        except Exception:
            self.state.publish("hardly")  # clean
        self.state.publish(label)  # sink name

    def on_other(self, msg):
        try:
            if not msg.data:
                raise ValueError("empty")
            self.mode = msg.data
        except ValueError:
            self.state.publish("empty")  # sink ~other

    def on_level(self, msg):
        try:
            self.level = math.sqrt(2.0)
        except ValueError:
            self.state.publish("never")  # clean
        int(msg.data)
        self.state.publish("whatever int does")  # clean


rospy.init_node("listener")
Listener()
rospy.spin()
