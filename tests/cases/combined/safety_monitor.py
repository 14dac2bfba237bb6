import rclpy
import time
from threading import Lock
from rclpy.node import Node
from rclpy.duration import Duration
from sensor_msgs.msg import LaserScan, BatteryState, Imu
from geometry_msgs.msg import Twist
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Bool


class Monitor(Node):
    def __init__(self):
        super().__init__('monitor')
        self._lock = Lock()
        self._stamps = {}
        self._values = {}
        self._faults = set()
        self._cmd = Twist()
        for name, kind in (('scan', LaserScan), ('imu', Imu)):
            self.create_subscription(kind, name, lambda m, n=name: self._beat(n, m), 10)  # source beat
        self.create_subscription(BatteryState, 'battery', self._battery, 10)  # source bat
        self.create_subscription(Twist, 'cmd_in', self._command, 10)  # source cmd
        self._out = self.create_publisher(Twist, 'cmd_out', 10)
        self._diag = self.create_publisher(DiagnosticArray, 'diagnostics', 10)
        self._ok = self.create_publisher(Bool, 'ok', 10)
        self.create_timer(0.2, self._check)

    def _beat(self, name, msg):
        with self._lock:
            self._stamps[name] = self.get_clock().now()

    def _battery(self, msg):
        with self._lock:
            self._values['battery'] = msg.percentage
            if msg.percentage < 0.1:
                self._faults.add('battery')
            else:
                self._faults.discard('battery')

    def _command(self, msg):
        if self._faults:
            self._out.publish(Twist())  # sink ~bat
            return
        self._out.publish(msg)  # sink cmd ~bat

    def _check(self):
        now = self.get_clock().now()
        with self._lock:
            stale = [n for n, t in self._stamps.items() if now - t > Duration(seconds=1.0)]
        arr = DiagnosticArray()
        arr.header.stamp = now.to_msg()
        st = DiagnosticStatus(name='monitor', level=DiagnosticStatus.OK)
        if stale:
            st.level = DiagnosticStatus.ERROR
        self._ok.publish(Bool(data=not stale))  # clean
        for key, value in self._values.items():
            st.values.append(KeyValue(key=key, value=str(value)))
        arr.status.append(st)
        self._diag.publish(arr)  # sink bat


def main():
    rclpy.init()
    n = Monitor()
    while rclpy.ok():
        rclpy.spin_once(n, timeout_sec=0.1)


main()
