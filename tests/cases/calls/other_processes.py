"""The outputs of another process may contain the data written to its input."""

import subprocess
from queue import Queue
from threading import Thread

import rospy
from std_msgs.msg import String


class Bridge:
    def __init__(self):
        self.lines = Queue()
        self.process = subprocess.Popen(["solver"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        Thread(target=self.listen, args=(self.process.stdout,)).start()
        self.out = rospy.Publisher("out", String, queue_size=1)
        self.state = rospy.Publisher("state", String, queue_size=1)
        rospy.Subscriber("task", String, self.on_task)  # source task
        rospy.Subscriber("query", String, self.on_query)  # source query
        rospy.Timer(rospy.Duration(0.1), self.tell)

    def on_task(self, msg):
        self.process.stdin.write(msg.data)
        self.process.stdin.flush()

    def listen(self, stream):
        for line in stream:
            self.lines.put(line)

    def on_query(self, msg):
        asked = subprocess.Popen(["lookup"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        answer, errors = asked.communicate(msg.data)
        self.state.publish(answer)  # sink query

    def tell(self, event):
        self.out.publish(self.lines.get_nowait())  # sink task
        clock = subprocess.Popen(["date"], stdout=subprocess.PIPE)
        self.state.publish(clock.stdout.read())  # clean


rospy.init_node("bridge")
Bridge()
rospy.spin()
