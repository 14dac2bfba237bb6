"""Data in strings: JSON over std_msgs/String, pickle in UInt8MultiArray, struct, base64 and templates."""

import base64
import json
import pickle
import struct
from string import Template

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import Float64, String, UInt8MultiArray

GREETING = Template("robot $name at $lat")


class Serialiser(Node):
    def __init__(self):
        super().__init__("serialiser")
        self.settings = {"rate": 1.0, "units": "m"}
        self.out = self.create_publisher(String, "json", 10)
        self.raw = self.create_publisher(UInt8MultiArray, "raw", 10)
        self.speed = self.create_publisher(Float64, "speed", 10)
        self.about = self.create_publisher(String, "about", 10)
        self.create_subscription(NavSatFix, "fix", self.on_fix, 10)  # source fix
        self.create_subscription(String, "request", self.on_request, 10)  # source request
        self.create_subscription(UInt8MultiArray, "packed", self.on_packed, 10)  # source packed

    def on_fix(self, msg):
        record = {"lat": msg.latitude, "lon": msg.longitude, "ok": msg.status.status >= 0}
        self.out.publish(String(data=json.dumps(record, indent=2)))  # sink fix
        self.raw.publish(UInt8MultiArray(data=list(pickle.dumps(record))))  # sink fix
        self.about.publish(String(data=GREETING.substitute(name="r1", lat=f"{msg.latitude:.3f}")))  # sink fix
        self.out.publish(String(data=json.dumps(self.settings)))  # sink request
        self.about.publish(String(data=GREETING.safe_substitute(name="r1", lat="?")))  # clean

    def on_request(self, msg):
        try:
            wish = json.loads(msg.data)
        except json.JSONDecodeError as error:
            self.about.publish(String(data=f"bad request: {error.msg}"))  # sink request
            return
        self.settings.update({k: v for k, v in wish.items() if k in self.settings})
        self.speed.publish(Float64(data=float(wish["motion"]["speed"])))  # sink request
        self.about.publish(String(data="accepted"))  # sink ~request

    def on_packed(self, msg):
        (speed, heading), rest = struct.unpack("<ff", bytes(msg.data[:8])), bytes(msg.data[8:])
        self.speed.publish(Float64(data=speed))  # sink packed
        text = base64.b64encode(rest).decode("ascii")
        self.out.publish(String(data=text))  # sink packed
        header = struct.pack("<BB", 0xAA, 0x55)
        self.raw.publish(UInt8MultiArray(data=list(header)))  # clean


def main():
    rclpy.init()
    rclpy.spin(Serialiser())


if __name__ == "__main__":
    main()
