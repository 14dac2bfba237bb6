"""The water tank as a simulator on real rospy, with /clock, /level, /valve, /step and /reset."""

import os
import threading

import rospy
from diagnostic_msgs.srv import SelfTest, SelfTestResponse
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

DT = 0.1  # s
FAULT, _, AT = os.environ.get("FAULT", "").partition(" ")


class Tank:
    """Level in m, valve in m/s at full pump."""

    def __init__(self):
        self.lock = threading.Lock()
        self.restart()
        self.clock_end = rospy.Publisher("/clock", Clock, queue_size=10)
        self.level_end = rospy.Publisher("/level", Float64, queue_size=10)
        rospy.Subscriber("/valve", Float64, self.on_valve)
        rospy.Service("/step", SelfTest, self.on_step)
        rospy.Service("/reset", SelfTest, self.on_reset)

    def restart(self):
        self.level, self.valve, self.steps, self.touched = 0.1, 0.0, 1, False

    def on_valve(self, message):
        with self.lock:
            self.valve, self.touched = message.data, True

    def advance(self):
        with self.lock:
            self.level += DT * float(os.environ.get("PUMP", "1")) * self.valve
            self.steps += 1
            if FAULT in ("die", "leave") and self.steps == int(AT):
                print("out of water", flush=True)
                if FAULT == "leave":  # the graph, well before the process ends
                    rospy.signal_shutdown("out of water")
                    threading.Event().wait(2.0)
                os._exit(3)
        self.publish()

    def show(self):
        """Publish the initial state, so that a program that connects later has it, too.

        The lock keeps the check and the message together: another thread could otherwise run a step between them, and
        the state after this step would be published twice.
        """
        with self.lock:
            if not self.touched:
                self.publish()

    def publish(self):
        self.clock_end.publish(Clock(rospy.Time(0, 0) + rospy.Duration.from_sec(DT * self.steps)))
        self.level_end.publish(Float64(self.level))

    def on_step(self, _):
        with self.lock:
            self.touched = True
        self.advance()
        return SelfTestResponse()

    def on_reset(self, _):
        with self.lock:
            self.restart()
        self.publish()
        return SelfTestResponse()


rospy.init_node("tank", disable_rostime=True)
assert rospy.get_param("/use_sim_time") is True
tank = Tank()
while not rospy.is_shutdown():
    threading.Event().wait(0.01)
    if "OWN_TIME" in os.environ:
        tank.advance()
    else:
        tank.show()
