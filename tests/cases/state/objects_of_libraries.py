"""A method stores its arguments in a library object, unless its name says that it only prints or queries."""

import image_geometry
import rospy
from filterpy.kalman import KalmanFilter
from geometry_msgs.msg import PointStamped, Twist
from hidden_markov import Tracker
from pid_controller import Pid
from plotting import Window
from sensor_msgs.msg import CameraInfo, Imu
from std_msgs.msg import Float64, String


class Estimator:
    def __init__(self, client=None):
        self.client = client
        self.camera = image_geometry.PinholeCameraModel()
        self.filter = KalmanFilter(dim_x=2, dim_z=1)
        self.tracker = Tracker(5)
        self.pid = Pid(1.0, 0.1)
        self.window = Window("state")
        self.socket = None
        self.link = Link()
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.speak = rospy.Publisher("say", String, queue_size=1)
        rospy.Subscriber("camera", CameraInfo, self.on_camera)  # source camera
        rospy.Subscriber("imu", Imu, self.on_imu)  # source imu
        rospy.Subscriber("depth", Float64, self.on_depth)  # source depth
        rospy.Subscriber("wish", Float64, self.on_wish)  # source wish
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_camera(self, msg):
        self.camera.fromCameraInfo(msg)

    def on_imu(self, msg):
        self.tracker.transition_update(msg.angular_velocity.z)
        self.window.show(msg.angular_velocity.z)
        self.window.is_visible(msg.angular_velocity.z)
        self.window.log_value("z", msg.angular_velocity.z)

    def on_depth(self, msg):
        self.filter.predict(msg.data)
        if self.socket is None:
            self.socket = open_socket()
        self.socket.send(str(msg.data))
        self.client.send(msg.data)
        self.link.port.sendall(msg.data)

    def on_wish(self, msg):
        effort = self.pid.step(msg.data)
        self.out.publish(effort)  # sink wish

    def tick(self, event):
        ray = self.camera.projectPixelTo3dRay((0, 0))
        self.out.publish(ray[0])  # sink camera
        self.out.publish(self.tracker.belief[0])  # sink imu
        self.out.publish(self.filter.x[0])  # sink depth
        self.out.publish(self.pid.integral)  # sink wish
        self.out.publish(self.window.width)  # clean
        if self.socket is None:
            self.speak.publish("no line")  # clean
        if self.client is not None:
            self.speak.publish("there")  # clean
        if self.link.port is None:
            self.speak.publish("no port")  # clean


class Link:
    def __init__(self):
        self.port = None


def open_socket():
    import socket

    return socket.create_connection(("robot", 7))


if __name__ == "__main__":
    rospy.init_node("estimator")
    Estimator()
    rospy.spin()
