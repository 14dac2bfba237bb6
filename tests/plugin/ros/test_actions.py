from __future__ import annotations

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

SERVER = """
    import time
    import rclpy
    from example_interfaces.action import Fibonacci
    from rclpy.action import ActionServer, CancelResponse, GoalResponse
    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.executors import MultiThreadedExecutor

    rclpy.init()
    node = rclpy.create_node("server")

    def execute(goal):
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        for i in range(1, goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=feedback.sequence)
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            goal.publish_feedback(feedback)
            time.sleep(0.5)
        if goal.request.order < 10:
            goal.succeed()
        return Fibonacci.Result(sequence=feedback.sequence)

    server = ActionServer(node, Fibonacci, "fibonacci", execute, callback_group=ReentrantCallbackGroup(),
                          goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order > 0 else GoalResponse.REJECT,
                          cancel_callback=lambda goal: CancelResponse.ACCEPT)
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    executor.spin()
"""
CLIENT = """
    import rclpy
    from example_interfaces.action import Fibonacci
    from rclpy.action import ActionClient

    rclpy.init()
    node = rclpy.create_node("client")
    client = ActionClient(node, Fibonacci, "fibonacci")
    log = []
    client.wait_for_server()

    def answered(future):
        handle = future.result()
        log.append(handle.accepted)
        if handle.accepted:
            handle.get_result_async().add_done_callback(
                lambda result: log.append((result.result().status, list(result.result().result.sequence))))
        if ORDER == 8:
            node.create_timer(0.6, lambda: handle.cancel_goal_async())

    goal = Fibonacci.Goal(order=ORDER)
    future = client.send_goal_async(goal, feedback_callback=lambda m: log.append(list(m.feedback.sequence)))
    future.add_done_callback(answered)
    rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("order", "log"),
    [
        (3, [True, [0, 1, 1], [0, 1, 1, 2], (4, [0, 1, 1, 2])]),
        (0, [False]),
        (8, [True, [0, 1, 1], [0, 1, 1, 2], (5, [0, 1, 1, 2])]),
    ],
    ids=["succeeds", "is refused", "is cancelled"],
)
def test_a_goal_travels_between_nodes_with_feedback_and_result(
    start: Start, order: int, log: list[object]
) -> None:
    ros = start(SERVER)
    start(CLIENT.replace("ORDER", str(order)), ros=ros)
    ros.step(6.0)
    assert ros.namespace["log"] == log


def test_a_goal_without_a_final_state_is_aborted(start: Start) -> None:
    ros = start(SERVER)
    start(CLIENT.replace("ORDER", "10"), ros=ros)
    ros.step(9.0)
    assert ros.namespace["log"][-1][0] == 6


def test_client_waits_while_another_thread_spins(start: Start) -> None:
    ros = start(SERVER)
    start(
        """
        import threading
        import rclpy
        from example_interfaces.action import Fibonacci
        from rclpy.action import ActionClient
        rclpy.init()
        node = rclpy.create_node("client")
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
        with ActionClient(node, Fibonacci, "fibonacci") as client:
            client.wait_for_server(timeout_sec=1.0)
            answer = client.send_goal(Fibonacci.Goal(order=2))
        done = (answer.status, list(answer.result.sequence))
    """,
        ros=ros,
    )
    ros.step(3.0)
    assert ros.namespace["done"] == (4, [0, 1, 1])


def test_invalid_goal_transitions_are_refused(start: Start) -> None:
    ros = start("""
        import rclpy
        from example_interfaces.action import Fibonacci
        from rclpy.action import ActionClient, ActionServer
        rclpy.init()
        node = rclpy.create_node("both")
        said = []
        def execute(goal):
            goal.succeed()
            try:
                goal.abort()
            except RuntimeError as error:
                said.append(str(error))
            return Fibonacci.Result()
        ActionServer(node, Fibonacci, "f", execute)
        client = ActionClient(node, Fibonacci, "f")
        try:
            client.send_goal_async(Fibonacci.Result())
        except TypeError as error:
            said.append(type(error).__name__)
        client.send_goal_async(Fibonacci.Goal())
        rclpy.spin(node)
    """)
    assert ros.namespace["said"][0] == "TypeError"
    assert "invalid transition from state 4 to 6" in ros.namespace["said"][1]


LIFECYCLE = """
    import rclpy
    from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
    from std_msgs.msg import String

    class Camera(LifecycleNode):
        def on_configure(self, state):
            self.pub = self.create_lifecycle_publisher(String, "image", 10)
            self.timer = self.create_timer(0.5, lambda: self.pub.publish(String(data="picture")))
            return TransitionCallbackReturn.SUCCESS

        def on_cleanup(self, state):
            raise RuntimeError("lens is stuck")

        def on_error(self, state):
            return TransitionCallbackReturn.SUCCESS

    rclpy.init()
    camera = Camera("camera")
    rclpy.spin(camera)
"""


def test_a_lifecycle_node_publishes_only_while_it_is_active(start: Start) -> None:
    change = message_type("lifecycle_msgs/srv/ChangeState")
    ros = start(LIFECYCLE)
    pictures, events = heard(ros, "/image"), heard(ros, "/camera/transition_event")

    def order(label: str) -> bool:
        request = change.Request()
        request.transition.label = label
        return bool(ros.bus.call("/camera/change_state", request).response.success)

    assert order("configure")
    ros.step(1.0)
    assert pictures == []
    assert order("activate")
    ros.step(1.0)
    assert len(pictures) == 2
    assert order("deactivate")
    assert not order("activate now")
    ros.step(1.0)
    assert len(pictures) == 2
    assert [event.goal_state.label for event in events[-2:]] == ["deactivating", "inactive"]


def test_a_failing_transition_goes_through_error_processing(start: Start) -> None:
    change, state = (message_type(f"lifecycle_msgs/srv/{name}") for name in ("ChangeState", "GetState"))
    ros = start(LIFECYCLE)
    for number, success in ((1, True), (2, False), (4, False)):
        request = change.Request()
        request.transition.id = number
        assert ros.bus.call("/camera/change_state", request).response.success is success
    current = ros.bus.call("/camera/get_state", state.Request()).response.current_state
    assert (current.id, current.label) == (1, "unconfigured")


ROS1_SERVER = """
    import actionlib, rospy
    from actionlib_tutorials.msg import FibonacciAction, FibonacciFeedback, FibonacciResult

    def execute(goal):
        feedback = FibonacciFeedback(sequence=[0, 1])
        for i in range(1, goal.order):
            if server.is_preempt_requested():
                server.set_preempted(FibonacciResult(feedback.sequence), "gave way")
                return
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            server.publish_feedback(feedback)
            rospy.sleep(0.5)
        server.set_succeeded(FibonacciResult(feedback.sequence))

    rospy.init_node("server")
    server = actionlib.SimpleActionServer("fibonacci", FibonacciAction, execute_cb=execute, auto_start=False)
    server.start()
    rospy.spin()
"""


def test_actionlib_goals_succeed_and_are_preempted(start: Start) -> None:
    ros = start(ROS1_SERVER)
    start(
        """
        import actionlib, rospy
        from actionlib_msgs.msg import GoalStatus
        from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
        rospy.init_node("client")
        client = actionlib.SimpleActionClient("fibonacci", FibonacciAction)
        log = [client.wait_for_server(rospy.Duration(1)), client.get_state() == GoalStatus.LOST]
        client.send_goal(FibonacciGoal(order=3), feedback_cb=lambda f: log.append(f.sequence))
        log.append(client.wait_for_result(rospy.Duration(0.2)))
        log.append(client.wait_for_result())
        log.append((client.get_state(), client.get_result().sequence))
        log.append(client.send_goal_and_wait(FibonacciGoal(order=9), rospy.Duration(0.7), rospy.Duration(2)))
        log.append(client.get_goal_status_text())
    """,
        ros=ros,
    )
    ros.step(8.0)
    assert ros.namespace["log"] == [
        True, True, (0, 1, 1), False, (0, 1, 1, 2), True, (3, (0, 1, 1, 2)), 2, "gave way",
    ]  # fmt: skip


def test_the_world_serves_an_actionlib_action_through_its_topics(start: Start) -> None:
    ros = start("pass")
    result = message_type("move_base_msgs/MoveBaseActionResult")

    def arrive(goal: object) -> None:
        answer = result()
        answer.status.goal_id, answer.status.status = goal.goal_id, 3  # type: ignore[attr-defined]
        ros.bus.publish("/move_base/result", answer)

    ros.bus.subscribe("/move_base/goal", arrive)
    start(
        """
        import actionlib, rospy
        from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
        rospy.init_node("patrol")
        client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        ready = client.wait_for_server()
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = "map"
        client.send_goal(goal, done_cb=lambda state, result: done.append(state))
        done = []
        client.wait_for_result()
    """,
        ros=ros,
    )
    ros.step(1.0)
    assert (ros.namespace["ready"], ros.namespace["done"]) == (True, [3])


def test_an_exception_in_an_execute_callback_aborts_the_goal(
    start: Start, caplog: pytest.LogCaptureFixture
) -> None:
    ros = start("""
        import actionlib, rospy
        from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
        rospy.init_node("both")
        def execute(goal):
            raise ValueError("no")
        server = actionlib.SimpleActionServer("f", FibonacciAction, execute, False)
        server.start()
        client = actionlib.SimpleActionClient("f", FibonacciAction)
        client.wait_for_server()
        state = client.send_goal_and_wait(FibonacciGoal(order=1))
    """)
    ros.step(1.0)
    assert ros.namespace["state"] == 4
    assert "Exception in your execute callback: no" in caplog.text


def test_unknown_service_error_lists_available_services(start: Start) -> None:
    ros = start(LIFECYCLE)
    with pytest.raises(
        Exception, match=r"No node serves /camera/stop now; available services: /camera/change_state"
    ):
        ros.bus.call("/camera/stop", message_type("std_srvs/srv/Trigger").Request())


def test_the_world_answers_a_rospy_node(start: Start) -> None:
    trigger = message_type("std_srvs/srv/Trigger")
    ros = start("pass")
    ros.bus.serve("/dock", trigger, lambda request: trigger.Response(success=True, message="docked"))
    start(
        """
        import rospy
        from std_srvs.srv import Trigger
        rospy.init_node("old")
        rospy.wait_for_service("dock")
        said = rospy.ServiceProxy("dock", Trigger)().message
    """,
        ros=ros,
    )
    assert ros.namespace["said"] == "docked"


def test_an_rclpy_node_calls_a_service_of_the_world(start: Start) -> None:
    trigger = message_type("std_srvs/srv/Trigger")
    ros = start("pass")
    ros.bus.serve("/dock", trigger, lambda request: trigger.Response(success=True, message="docked"))
    start(
        """
        import rclpy
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("new")
        future = node.create_client(Trigger, "dock").call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future)
        said = future.result().message
    """,
        ros=ros,
    )
    assert ros.namespace["said"] == "docked"


def test_failing_handler_does_not_end_the_server(start: Start) -> None:
    ros = start("""
        import rospy
        from std_srvs.srv import SetBool
        rospy.init_node("n")
        def handle(request):
            raise ValueError("jammed")
        rospy.Service("arm", SetBool, handle)
        try:
            rospy.ServiceProxy("arm", SetBool)(True)
        except rospy.ServiceException as error:
            said = str(error)
        rospy.spin()
    """)
    assert "error processing request: jammed" in ros.namespace["said"]
    assert ros.alive


def test_service_without_a_response_ends_its_rclpy_node(start: Start) -> None:
    ros = start("""
        import rclpy
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("n")
        node.create_service(Trigger, "ask", lambda request, response: None)
        rclpy.spin(node)
    """)
    with pytest.raises(NodeError, match="the callback of service /ask returned"):
        ros.bus.call("/ask", message_type("std_srvs/srv/Trigger").Request())
