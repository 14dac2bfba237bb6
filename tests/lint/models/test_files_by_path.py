"""What a program writes into a file is read from the same path, and from no other."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import codecs, csv, cv2, json, os, pickle, rospy, yaml
import numpy as np
from pathlib import Path
from std_msgs.msg import Float64, String
PATH = "/tmp/state.json"
OTHER = "/tmp/other.json"
class Node:
    def __init__(self):
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.path = os.path.expanduser("~/.ros/state.json")
        self.file = Path("/tmp/state.txt")
        self.setup()
        rospy.Subscriber("scan", Float64, self.scan)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def setup(self): pass
    def scan(self, msg): pass
    def tick(self, event): pass
"""
BODIES = """\
### json
    def scan(self, msg):
        with open(PATH, "w") as f:
            json.dump({"x": msg.data}, f)
    def tick(self, event):
        with open(PATH) as f:
            self.out.publish(json.load(f)["x"])  # scan:data
        with open(OTHER) as f:
            self.out.publish(json.load(f)["x"])  # clean
### text
    def scan(self, msg):
        with open("/tmp/a.txt", "w") as f:
            f.write(str(msg.data))
    def tick(self, event):
        self.out.publish(float(open("/tmp/a.txt").read()))  # scan:data
        self.out.publish(float(open("/tmp/b.txt").read()))  # clean
### pickle
    def scan(self, msg):
        pickle.dump(msg, open(self.path, "wb"))
    def tick(self, event):
        self.out.publish(pickle.load(open(self.path, "rb")).data)  # scan:data
### yaml
    def scan(self, msg):
        with open(self.path, "w") as f:
            yaml.safe_dump({"x": msg.data}, f)
    def tick(self, event):
        with open(self.path) as f:
            data = yaml.safe_load(f)
        self.out.publish(data["x"])  # scan:data
### pathlib
    def scan(self, msg):
        self.file.write_text(json.dumps({"x": msg.data}))
    def tick(self, event):
        self.out.publish(json.loads(self.file.read_text())["x"])  # scan:data
        if self.file.exists():
            self.out.publish(3.0)  # clean
### numpy
    def scan(self, msg):
        np.save("/tmp/a.npy", msg.data)
    def tick(self, event):
        self.out.publish(np.load("/tmp/a.npy"))  # scan:data
### lines
    def scan(self, msg):
        with open("/tmp/log.csv", "a") as f:
            f.write("%f\\n" % msg.data)
    def tick(self, event):
        for line in open("/tmp/log.csv"):
            self.out.publish(float(line))  # scan:data
### csv
    def scan(self, msg):
        with open("/tmp/log.csv", "a") as f:
            csv.writer(f).writerow([msg.data])
    def tick(self, event):
        with open("/tmp/log.csv") as f:
            for row in csv.reader(f):
                self.out.publish(float(row[0]))  # scan:data
### print
    def scan(self, msg):
        with open("/tmp/log.csv", "a") as f:
            print(msg.data, file=f)
    def tick(self, event):
        with open("/tmp/log.csv") as f:
            self.out.publish(f.readline())  # scan:data
### join
    def setup(self):
        self.dir = "/tmp/x"
    def scan(self, msg):
        with open(os.path.join(self.dir, "a.json"), "w") as f:
            json.dump(msg.data, f)
    def tick(self, event):
        with open(os.path.join(self.dir, "a.json")) as f:
            self.out.publish(json.load(f))  # scan:data
        with open(os.path.join(self.dir, "b.json")) as f:
            self.out.publish(json.load(f))  # clean
### condition
    def scan(self, msg):
        if msg.data > 1.0:
            with open(PATH, "w") as f:
                f.write("on")
    def tick(self, event):
        with open(PATH) as f:
            self.out.publish(f.read())  # scan:control
### param
    def setup(self):
        self.where = rospy.get_param("~file", "/tmp/q.json")
    def scan(self, msg):
        json.dump(msg.data, open(self.where, "w"))
    def tick(self, event):
        self.out.publish(json.load(open(self.where)))  # scan:data
### images and other functions
    def scan(self, msg):
        cv2.imwrite("/tmp/a.png", msg.data)
        codecs.open("/tmp/c.txt", "w", "utf-8").write(msg.text)
    def tick(self, event):
        self.out.publish(cv2.imread("/tmp/a.png"))  # scan:data
        self.out.publish(codecs.open("/tmp/c.txt").read())  # scan:data
        self.out.publish(cv2.imread("/tmp/b.png"))  # clean
### attributes of a file
    def scan(self, msg):
        with open(PATH, "w") as f:
            f.write(msg.text)
            self.out.publish(f.name)  # clean
            self.out.publish(f.closed)  # clean
### methods of a path
    def scan(self, msg):
        with self.file.open("w") as f:
            f.write(msg.text)
        Path(PATH).write_bytes(msg.data)
    def tick(self, event):
        self.out.publish(self.file.read_text())  # scan:data
        self.out.publish(open(PATH, "rb").read())  # scan:data
        self.out.publish(open(str(self.file)).read())  # scan:data
        self.out.publish(Path(OTHER).read_text())  # clean
### a path in the message
    def scan(self, msg):
        with open(msg.path, "w") as f:
            f.write(msg.text)
        self.out.publish(open(msg.path).read())  # scan:data
    def tick(self, event):
        self.out.publish(open(PATH).read())  # clean
### what an earlier run has left
    def setup(self):
        self.offset = self.later = 0.0
        if os.path.exists(PATH):
            with open(PATH) as f:
                self.offset = json.load(f)["x"]
    def scan(self, msg):
        with open(PATH, "w") as f:
            json.dump({"x": msg.data}, f)
    def tick(self, event):
        self.out.publish(self.offset)  # clean
        with open(PATH) as f:
            self.later = json.load(f)["x"]
        self.out.publish(self.later)  # scan:data
### a device returns other data
    def setup(self):
        self.port = open("/dev/ttyUSB0", "r+b")
    def scan(self, msg):
        self.port.write(msg.data)
    def tick(self, event):
        self.out.publish(self.port.read())  # clean
"""
CASES = sections(BODIES)
LOOP = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
def scan(msg):
    with open("/tmp/a.txt", "w") as f:
        f.write(msg.data)
rospy.Subscriber("scan", Float64, scan)
out.publish(open("/tmp/a.txt").read())  # clean
rate = rospy.Rate(1.0)
while not rospy.is_shutdown():
    rate.sleep()
    out.publish(open("/tmp/a.txt").read())  # scan:data
"""


@pytest.mark.parametrize("title", CASES)
def test_files_with_a_known_path(title):
    assert differing_topics(f"{HEAD}{CASES[title]}Node()\nrospy.spin()\n") == {}


def test_a_loop_reads_what_callbacks_write_while_it_sleeps():
    assert differing_topics(LOOP) == {}
