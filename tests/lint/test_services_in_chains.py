"""Flows across nodes through services and actions: requests, responses, goals and results."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tests.lint.test_parameter_names import arm, node  # noqa: F401 - `arm` is a fixture
from tests.lint.test_system import flows, run, write

CLIENT = """\
#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Twist
from robot.srv import Plan
from sensor_msgs.msg import LaserScan

class Pilot:
    def __init__(self):
        self.plan = rospy.ServiceProxy(rospy.get_param("~planner", "plan"), Plan)
        self.out = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)

    def on_scan(self, scan):
        answer = self.plan(min(scan.ranges))
        command = Twist()
        command.linear.x = answer.speed
        self.out.publish(command)

rospy.init_node("pilot")
Pilot()
rospy.spin()
"""
SERVER = """\
#!/usr/bin/env python3
import rospy
from nav_msgs.msg import Odometry
from robot.srv import Plan, PlanResponse
from std_msgs.msg import Float64

speed = 0.0
def on_odom(odom):
    global speed
    speed = odom.twist.twist.linear.x

def plan(request):
    debug.publish(request.distance)
    return PlanResponse(speed=speed)

rospy.init_node("planner")
debug = rospy.Publisher("debug", Float64, queue_size=1)
rospy.Subscriber("odom", Odometry, on_odom)
rospy.Service("plan", Plan, plan)
rospy.spin()
"""
ACTIONS = """\
#!/usr/bin/env python3
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import NavigateToPose

class Sender(Node):
    def __init__(self):
        super().__init__("sender")
        self.client = ActionClient(self, NavigateToPose, "navigate")
        self.create_subscription(PoseStamped, "goal_pose", self.on_pose, 10)

    def on_pose(self, pose):
        goal = NavigateToPose.Goal()
        goal.pose = pose
        self.client.send_goal_async(goal)

def main():
    rclpy.init()
    rclpy.spin(Sender())

if __name__ == "__main__":
    main()
"""
ACTION_SERVER = """\
#!/usr/bin/env python3
import rclpy
from rclpy.action import ActionServer
from rclpy.node import Node
from geometry_msgs.msg import Twist
from nav2_msgs.action import NavigateToPose

class Navigator(Node):
    def __init__(self):
        super().__init__("navigator")
        self.out = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(self, NavigateToPose, "navigate", self.execute)

    def execute(self, handle):
        command = Twist()
        command.linear.x = handle.request.pose.pose.position.x
        self.out.publish(command)
        handle.succeed()
        return NavigateToPose.Result()

def main():
    rclpy.init()
    rclpy.spin(Navigator())

if __name__ == "__main__":
    main()
"""


def services(arm: Path, body: str) -> None:  # noqa: F811
    files = {"arm/scripts/relay.py": CLIENT, "arm/scripts/server.py": SERVER, "arm/scripts/send.py": ACTIONS,
             "arm/scripts/navigate.py": ACTION_SERVER, "arm/launch/a.launch": f"<launch>{body}</launch>"}  # fmt: skip
    write(arm, files)


def server(name: str, script: str = "server.py") -> str:
    return f'<node pkg="arm" type="{script}" name="{name}"><remap from="plan" to="better"/></node>'


def test_a_chain_passes_through_a_service(arm, capsys: pytest.CaptureFixture[str]) -> None:  # noqa: F811
    services(arm, node("pilot", '<param name="planner" value="better"/>') + server("planner"))
    assert flows(run(capsys, "--launch", "a.launch")[1]) == [
        "/odom → /planner → /better (response) → /pilot → /cmd_vel  explicit",
        "/scan → /pilot → /better (request) → /planner → /debug  explicit",
    ]  # not /scan → /cmd_vel, since the server does not use the request in its response
    out = run(capsys, "--launch", "a.launch", "--from", "/odom", "--to", "/cmd_vel", "--show-paths")[1]
    assert "answer = self.plan(min(scan.ranges))" in out
    assert "return PlanResponse(speed=speed)" in out


def test_services_with_different_names_are_not_connected(arm, capsys: pytest.CaptureFixture[str]) -> None:  # noqa: F811
    services(arm, node("pilot") + server("planner"))
    assert flows(run(capsys, "--launch", "a.launch", "--from", "/odom", "--to", "/cmd_vel")[1]) == []


def test_a_chain_passes_through_an_action(arm, capsys: pytest.CaptureFixture[str]) -> None:  # noqa: F811
    services(arm, server("sender", "send.py") + server("navigator", "navigate.py"))
    assert flows(run(capsys, "--launch", "a.launch")[1]) == [
        "/goal_pose → /sender → /navigate (goal) → /navigator → /cmd_vel  explicit"
    ]


@pytest.mark.parametrize("form", ["svg", "mermaid", "json"])
def test_pictures_and_json_show_services(arm, capsys: pytest.CaptureFixture[str], form: str) -> None:  # noqa: F811
    services(arm, node("pilot", '<param name="planner" value="better"/>') + server("planner"))
    assert "/better (request)" in run(capsys, "--launch", "a.launch", "--format", form)[1]


ONLY_CLIENTS = {
    "service": """
        client = rospy.ServiceProxy("agent", Step)
        answer = client(0)
        while not rospy.is_shutdown():
            answer = client(answer.state)
        """,
    "simple action": """
        client = actionlib.SimpleActionClient("agent", StepAction)
        while not rospy.is_shutdown():
            last = client.get_result()
            client.send_goal(StepGoal(last.state))
        """,
    "service of ROS 2": """
        rclpy.init()
        node = rclpy.create_node("only")
        client = node.create_client(Step, "agent")
        request = Step.Request()
        while rclpy.ok():
            future = client.call_async(request)
            rclpy.spin_until_future_complete(node, future)
            request.state = future.result().state
        """,
}


@pytest.mark.parametrize("kind", ONLY_CLIENTS)
def test_a_node_with_clients_only_is_analysed(kind, arm, capsys):  # noqa: F811 - the fixture
    head = "#!/usr/bin/env python3\nimport actionlib, rclpy, rospy\nfrom robot.srv import *\nrospy.init_node('only')\n"
    write(arm, {"arm/scripts/only.py": head + dedent(ONLY_CLIENTS[kind])})
    write(arm, {"arm/launch/a.launch": '<launch><node pkg="arm" type="only.py" name="only"/></launch>'})
    _, out, _ = run(capsys, "--launch", str(arm / "arm/launch/a.launch"))
    ends = ("result", "goal") if "action" in kind else ("response", "request")
    assert any(f"/agent ({ends[0]}) → /only → /agent ({ends[1]})" in line for line in flows(out)), out


FEEDBACK_OF_ROS1 = {
    "server": """
        import actionlib, rospy
        from move_base_msgs.msg import *
        from std_msgs.msg import Float64

        nearest = 0.0
        def on_scan(scan):
            global nearest
            nearest = scan.data

        def execute(goal):
            server.publish_feedback(MoveBaseFeedback(nearest))
            server.set_succeeded(MoveBaseResult())

        rospy.init_node("server")
        rospy.Subscriber("scan", Float64, on_scan)
        server = actionlib.SimpleActionServer("drive", MoveBaseAction, execute, False)
        rospy.spin()
        """,
    "client": """
        import actionlib, rospy
        from move_base_msgs.msg import *
        from std_msgs.msg import Float64

        def done(state, result):
            ended.publish(state)

        def feedback(message):
            heard.publish(message.base_position)

        def on_goal(message):
            client.send_goal(MoveBaseGoal(message.data), done, feedback_cb=feedback)

        rospy.init_node("client")
        ended = rospy.Publisher("ended", Float64, queue_size=1)
        heard = rospy.Publisher("heard", Float64, queue_size=1)
        client = actionlib.SimpleActionClient("drive", MoveBaseAction)
        rospy.Subscriber("wish", Float64, on_goal)
        rospy.spin()
        """,
}
FEEDBACK_OF_ROS2 = {
    "server": """
        import rclpy
        from rclpy.action import ActionServer
        from rclpy.node import Node
        from nav2_msgs.action import NavigateToPose
        from std_msgs.msg import Float64

        class Server(Node):
            def __init__(self):
                super().__init__("server")
                self.nearest = 0.0
                self.server = ActionServer(self, NavigateToPose, "drive", self.execute)
                self.create_subscription(Float64, "scan", self.on_scan, 10)

            def on_scan(self, scan):
                self.nearest = scan.data

            def execute(self, goal):
                feedback = NavigateToPose.Feedback()
                feedback.distance_remaining = self.nearest
                goal.publish_feedback(feedback)
                goal.succeed()
                return NavigateToPose.Result()

        rclpy.init()
        rclpy.spin(Server())
        """,
    "client": """
        import rclpy
        from rclpy.action import ActionClient
        from rclpy.node import Node
        from nav2_msgs.action import NavigateToPose
        from std_msgs.msg import Float64

        class Client(Node):
            def __init__(self):
                super().__init__("client")
                self.client = ActionClient(self, NavigateToPose, "drive")
                self.ended = self.create_publisher(Float64, "ended", 10)
                self.heard = self.create_publisher(Float64, "heard", 10)
                self.create_subscription(Float64, "wish", self.on_wish, 10)

            def on_wish(self, wish):
                goal = NavigateToPose.Goal()
                goal.pose.pose.position.x = wish.data
                sent = self.client.send_goal_async(goal, feedback_callback=self.on_feedback)
                sent.add_done_callback(lambda sent: sent.result().get_result_async().add_done_callback(self.done))

            def done(self, future):
                self.ended.publish(Float64(data=float(future.result().result.error_code)))

            def on_feedback(self, message):
                self.heard.publish(Float64(data=message.feedback.distance_remaining))

        rclpy.init()
        rclpy.spin(Client())
        """,
}


@pytest.mark.parametrize("programs", [FEEDBACK_OF_ROS1, FEEDBACK_OF_ROS2], ids=["ROS 1", "ROS 2"])
def test_feedback_of_an_action_is_not_its_result(programs, arm, capsys):  # noqa: F811 - the fixture
    shebang = "#!/usr/bin/env python3\n"
    write(arm, {f"arm/scripts/{name}.py": shebang + dedent(text) for name, text in programs.items()})
    nodes = "".join(f'<node pkg="arm" type="{name}.py" name="{name}"/>' for name in programs)
    write(arm, {"arm/launch/a.launch": f"<launch>{nodes}</launch>"})
    _, out, _ = run(capsys, "--launch", str(arm / "arm/launch/a.launch"))
    assert flows(out) == [
        "/drive (result) → /client → /ended  explicit",
        "/scan → /server → /drive (feedback) → /client → /heard  explicit",
        "/wish → /client → /drive (goal)  explicit",
    ]


def test_a_server_that_is_not_read_may_send_feedback(arm, capsys):  # noqa: F811 - the fixture
    write(arm, {"arm/scripts/client.py": "#!/usr/bin/env python3\n" + dedent(FEEDBACK_OF_ROS1["client"])})
    write(arm, {"arm/launch/a.launch": '<launch><node pkg="arm" type="client.py" name="client"/></launch>'})
    _, out, _ = run(capsys, "--launch", str(arm / "arm/launch/a.launch"), "--to", "/heard")
    server_ = "[server of /drive, not read]"
    assert flows(out) == [
        f"/wish → /client → /drive (goal) → {server_} → /drive (feedback) → /client → /heard  not read"
    ]
