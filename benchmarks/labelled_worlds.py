"""Worlds for the nodes of benchmarks/labelled_nodes.py: each publishes the topics that its node subscribes to."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from pytest_tarl.ros import message_type

World = Callable[[Any, str, Any, Path], None]  # (tarl, path of the node, monkeypatch, scratch folder)
PATROL_CLIENT = """
import rclpy
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from turtlebot3_msgs.action import Patrol

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, Patrol, "turtlebot3")
client.wait_for_server()
goal = Patrol.Goal()
goal.goal.x, goal.goal.y, goal.goal.z = {kind}, 0.5, 1.0
client.send_goal_async(goal, feedback_callback=lambda message: None)
try:
    rclpy.spin(node)
except ExternalShutdownException:
    pass
"""
QOS_TALKER = """
import sys
sys.path.insert(0, {folder!r})
import rclpy
from common_nodes import Listener, Talker
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import QoSProfile

rclpy.init()
profile = QoSProfile(depth=10, deadline=Duration(seconds=1))
executor = SingleThreadedExecutor()
talker = Talker("qos_chatter", profile, PublisherEventCallbacks(deadline=print), 12, assert_topic_period=0.4)
executor.add_node(talker)
executor.add_node(Listener("qos_chatter", profile, SubscriptionEventCallbacks(deadline=print)))
talker.create_timer(2.0, lambda: talker.pause_for(1.0))
talker.create_timer(9.0, talker.stop)
try:
    executor.spin()
except ExternalShutdownException:
    pass
"""


class Robot:
    """A unicycle that follows /cmd_vel and publishes /odom."""

    def __init__(self, odometry: str, command_topic: str = "/cmd_vel") -> None:
        self._odometry = message_type(odometry)
        self._topic = command_topic
        self.x = self.y = self.yaw = 0.0

    def move(self, bus: Any, dt: float) -> None:
        """Move for one step, and publish the odometry."""
        command = bus.latest(self._topic)
        if command is not None:
            self.yaw += command.angular.z * dt
            self.x += command.linear.x * math.cos(self.yaw) * dt
            self.y += command.linear.x * math.sin(self.yaw) * dt
        odometry = self._odometry()
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.x, self.y
        odometry.pose.pose.orientation.z, odometry.pose.pose.orientation.w = (
            math.sin(self.yaw / 2),
            math.cos(self.yaw / 2),
        )
        bus.publish("/odom", odometry)


def _drive(tarl: Any, steps: int, dt: float, feed: Callable[[int], None]) -> None:
    """Run an episode: the world, the node and a reward in each step."""
    for step in range(steps):
        tarl.observe(step=step)
        feed(step)
        tarl.step(dt)
        tarl.reward(1.0)


def absolute_move(tarl: Any, node: str, monkeypatch: Any, _folder: Path) -> None:
    """Type goals in all directions at the prompt; the heading crosses ±180° in both directions."""
    here = (-0.4, 0.3)
    goals = [
        (*here, 170.0),
        (*here, -170.0),
        (*here, 170.0),
        (-0.4, -0.3, -170.0),
        (0.2, 0.2, 200.0),
        (0.4, -0.4, -200.0),
    ]
    typed = iter([str(number) for goal in [*goals, (-0.6, 0.1, 10.0)] * 40 for number in goal])
    monkeypatch.setattr("builtins.input", lambda _prompt="": next(typed))
    monkeypatch.setenv("ROS_DISTRO", "humble")
    tarl.start(node)
    robot = Robot("nav_msgs/msg/Odometry")
    _drive(tarl, 3000, 0.05, lambda _: robot.move(tarl.bus, 0.05))


def obstacle_detection(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Publish scans with an intermittent wall, and another node's commands."""
    scan, twist = message_type("sensor_msgs/msg/LaserScan"), message_type("geometry_msgs/msg/Twist")
    tarl.start(node)

    def feed(step: int) -> None:
        tarl.bus.publish("/scan", scan(ranges=[0.3 if step % 10 < 4 else 2.0] * 360))
        command = twist()
        command.linear.x = 0.1
        tarl.bus.publish("/cmd_vel_raw", command)

    _drive(tarl, 60, 0.1, feed)


def patrol(tarl: Any, node: str, _monkeypatch: Any, folder: Path) -> None:
    """Request a square or a triangle as a client, depending on the seed."""
    kind = 1.0 if tarl.seed % 2 else 2.0
    client = folder / "client.py"
    client.write_text(PATROL_CLIENT.format(kind=kind))
    tarl.observe(step=0)
    tarl.start(node)
    tarl.start(str(client))
    robot = Robot("nav_msgs/msg/Odometry")
    _drive(tarl, 3000, 0.02, lambda _: robot.move(tarl.bus, 0.02))


def keyboard(tarl: Any, node: str, monkeypatch: Any, _folder: Path) -> None:
    """Type keys at a terminal."""
    master, slave = os.openpty()
    monkeypatch.setenv("TURTLEBOT3_MODEL", "burger")
    with os.fdopen(slave, "r") as terminal:
        monkeypatch.setattr(sys, "stdin", terminal)
        tarl.start(node)
        keys = "wwaaxd wdsw"
        _drive(tarl, 44, 0.1, lambda step: None if step % 4 else _type(master, keys[step // 4]))
        tarl.close()
    os.close(master)


def _type(master: int, key: str) -> None:
    os.write(master, key.encode())


def yolo(tarl: Any, node: str, monkeypatch: Any, _folder: Path) -> None:
    """Publish camera images; a network that returns its input replaces the real one."""

    class Found:
        def __init__(self, frame: Any) -> None:
            self._frame = frame

        def plot(self) -> Any:
            return self._frame

    network = ModuleType("ultralytics")
    network.YOLO = lambda _path: lambda frame: [Found(frame)]  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ultralytics", network)
    image = message_type("sensor_msgs/msg/Image")
    tarl.start(node)
    picture = image(height=8, width=8, encoding="rgb8", step=24, data=bytes(range(192)))
    _drive(tarl, 20, 0.1, lambda _: tarl.bus.publish("/camera/image_raw", picture))


def qos_nodes(tarl: Any, node: str, _monkeypatch: Any, folder: Path) -> None:
    """Run both node classes in the file in a small program."""
    program = folder / "talk.py"
    program.write_text(QOS_TALKER.format(folder=str(Path(node).parent)))
    tarl.start(str(program))
    _drive(tarl, 100, 0.1, lambda _: None)


def lifecycle_talker(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Drive the node through its lifecycle states."""
    change = message_type("lifecycle_msgs/srv/ChangeState")
    tarl.start(node)
    orders = {5: 1, 25: 3, 60: 4, 65: 2, 70: 1, 75: 3, 90: 7}

    def feed(step: int) -> None:
        if step in orders:
            request = change.Request()
            request.transition.id = orders[step]
            assert tarl.bus.call("/lc_talker/change_state", request).response.success

    _drive(tarl, 100, 0.1, feed)


def alone(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Publish nothing."""
    tarl.start(node)
    _drive(tarl, 100, 0.1, lambda _: None)


def wander(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Publish a wall ahead from time to time, so that the node both turns and drives."""
    scan = message_type("sensor_msgs/LaserScan")
    tarl.start(node)
    _drive(
        tarl,
        500,
        0.1,
        lambda step: tarl.bus.publish("/scan", scan(ranges=[0.5 if step % 90 < 9 else 3.0] * 10)),
    )


def line_follower(tarl: Any, node: str, monkeypatch: Any, _folder: Path) -> None:
    """Publish images of a yellow stripe; no windows are opened."""
    vision = import_module("cv2")
    for window in ("namedWindow", "imshow", "waitKey"):
        monkeypatch.setattr(vision, window, lambda *_: None)
    image = message_type("sensor_msgs/Image")
    tarl.start(node)
    picture = image(height=80, width=4, encoding="bgr8", step=12, data=bytes([0, 200, 200] * 320))
    _drive(tarl, 20, 0.1, lambda _: tarl.bus.publish("/camera/rgb/image_raw", picture))


def parameters(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Set the parameters of the launch file."""
    gains = {"P": 1.0, "I": 2.0, "D": 3.0}
    given = {"/global_example": "global", "/utterance": "hello", "~topic_name": "chatter", "/gains": gains}
    tarl.start(node, parameters=given)
    _drive(tarl, 50, 0.1, lambda _: None)


def ball(tarl: Any, node: str, _monkeypatch: Any, _folder: Path) -> None:
    """Publish a ball to the left, to the right, far away, and out of sight."""
    point = message_type("geometry_msgs/Point")
    tarl.start(node)

    def feed(step: int) -> None:
        if step % 60 < 40:
            tarl.bus.publish("/blob/point_blob", point((-1.0, 0.1, 1.0)[step // 60 % 3], 0.0, 0.0))

    _drive(tarl, 200, 0.1, feed)


def sonar(tarl: Any, node: str, _monkeypatch: Any, folder: Path) -> None:
    """Publish commands of a driver and of the obstacle avoidance; define the servo board's messages."""
    messages = folder / "i2cpwm_board" / "msg"
    messages.mkdir(parents=True)
    (messages / "Servo.msg").write_text("int16 servo\nfloat32 value\n")
    (messages / "ServoArray.msg").write_text("Servo[] servos\n")
    (folder / "i2cpwm_board" / "package.xml").write_text("<package><name>i2cpwm_board</name></package>")
    tarl.ros.use_definitions_around(folder / "i2cpwm_board")
    twist = message_type("geometry_msgs/Twist")
    tarl.start(node)

    def feed(step: int) -> None:
        for topic in ("/cmd_vel", "/dkcar/control/cmd_vel"):
            command = twist()
            command.linear.x, command.angular.z = 0.5 - step / 50, 0.3
            tarl.bus.publish(topic, command)

    _drive(tarl, 100, 0.1, feed)


WORLDS: dict[str, World] = {
    "turtlebot3_absolute_move.py": absolute_move,
    "turtlebot3_obstacle_detection.py": obstacle_detection,
    "turtlebot3_patrol_server.py": patrol,
    "teleop_keyboard.py": keyboard,
    "turtlebot3_yolo_object_detection.py": yolo,
    "common_nodes.py": qos_nodes,
    "talker.py": lifecycle_talker,
    "custom_callback_group.py": alone,
    "wander.py": wander,
    "follower_p.py": line_follower,
    "param_talker.py": parameters,
    "chase_the_ball.py": ball,
    "low_level_control_with_sonar.py": sonar,
}
