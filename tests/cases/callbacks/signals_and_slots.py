"""Emitting a signal calls the functions connected to it with the emitted values; users click buttons at any time."""

import sys

import rospy
from PyQt5.QtCore import QObject, QTimer, pyqtSignal
from PyQt5.QtWidgets import QApplication, QLabel, QPushButton, QWidget
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float32, String


class Bridge(QObject):
    battery = pyqtSignal(float)
    text = pyqtSignal(str)
    low = pyqtSignal()

    def __init__(self):
        super().__init__()
        rospy.Subscriber("battery", BatteryState, self.on_battery)  # source battery
        rospy.Subscriber("text", String, self.on_text)  # source text

    def on_battery(self, msg):
        self.battery.emit(msg.percentage * 100)
        if msg.voltage < 11.0:
            self.low.emit()

    def on_text(self, msg):
        self.text.emit(msg.data)


class Panel(QWidget):
    def __init__(self):
        super().__init__()
        self.level = rospy.Publisher("level", Float32, queue_size=1)
        self.echo = rospy.Publisher("echo", String, queue_size=1)
        self.stop = rospy.Publisher("stop", Bool, queue_size=1)
        self.ros = Bridge()
        self.ros.battery.connect(self.show_battery)
        self.ros.text.connect(lambda t: self.echo.publish(t))  # sink text
        self.ros.low.connect(self.warn)
        self.label = QLabel("?")
        self.button = QPushButton("stop")
        self.button.clicked.connect(self.clicked)
        self.timer = QTimer(self)
        self.timer.timeout.connect(self.tick)

    def show_battery(self, percent):
        self.label.setText(str(percent))
        self.level.publish(percent)  # sink battery
        self.echo.publish("seen")  # clean

    def warn(self):
        self.echo.publish("low")  # sink ~battery

    def clicked(self):
        self.stop.publish(True)  # clean

    def tick(self):
        self.level.publish(1.0)  # clean


rospy.init_node("panel")
app = QApplication(sys.argv)
panel = Panel()
panel.show()
app.exec_()
