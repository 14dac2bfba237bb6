"""Values of a wrong type that a test passes to `tarl.bus` are refused in a sentence, never read as an empty message."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start

TRIGGER, SWITCH = message_type("std_srvs/srv/Trigger"), message_type("std_srvs/srv/SetBool")
OLD_TRIGGER, OLD_SWITCH = message_type("std_srvs/Trigger"), message_type("std_srvs/SetBool")
CLIENTS = {
    "rospy": """
        import rospy
        from std_srvs.srv import Trigger
        rospy.init_node("caller")
        try:
            said = rospy.ServiceProxy("dock", Trigger)().message
        except rospy.ServiceException as error:
            said = str(error)
    """,
    "rclpy": """
        import rclpy
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("caller")
        future = node.create_client(Trigger, "dock").call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future)
        said = future.result().message
    """,
}
SERVERS = {
    "rospy": """
        import rospy
        from std_srvs.srv import SetBool, SetBoolResponse
        rospy.init_node("server")
        rospy.Service("switch", SetBool, lambda request: SetBoolResponse(request.data, "old"))
        rospy.spin()
    """,
    "rclpy": """
        import rclpy
        from std_srvs.srv import SetBool
        rclpy.init()
        node = rclpy.create_node("server")
        node.create_service(SetBool, "switch", lambda request, _: SetBool.Response(success=request.data))
        rclpy.spin(node)
    """,
}
NO_RESPONSE = {
    "dict": ({"success": True}, "not dict"),
    "tuple": ((True, ""), "not tuple"),
    "text": ("docked", "not str"),
    "bool": (True, "not bool"),
    "class": (TRIGGER.Response, "not the class Trigger_Response"),
    "service": (TRIGGER, "not the class Trigger"),
    "request": (TRIGGER.Request(), "not std_srvs/Trigger_Request"),
    "other": (SWITCH.Response(success=True), "not std_srvs/SetBool_Response"),
}
NO_REQUEST = {
    "dict": ({"data": True}, "not dict"),
    "None": (None, "not None"),
    "bool": (True, "not bool"),
    "class": (SWITCH.Request, "not the class SetBool_Request"),
    "response": (SWITCH.Response(), "not std_srvs/SetBool_Response"),
    "other": (TRIGGER.Request(), "not std_srvs/Trigger_Request"),
}


@pytest.mark.parametrize("node", CLIENTS)
@pytest.mark.parametrize("wrong", NO_RESPONSE)
def test_a_response_of_another_type_is_refused(start: Start, node: str, wrong: str) -> None:
    returned, seen = NO_RESPONSE[wrong]
    ros = start("pass")
    ros.bus.serve("dock", TRIGGER, lambda _: returned)
    with pytest.raises(RecordingError) as refused:
        start(CLIENTS[node], ros=ros)
    assert str(refused.value) == (
        f"The response of the test's handler of /dock must be of type std_srvs/Trigger_Response, {seen}: "
        "make one with message_type('std_srvs/srv/Trigger').Response(…)."
    )


def test_ros1_service_refuses_a_request_by_returning_none(start: Start) -> None:
    ros = start("pass")
    ros.bus.serve("dock", OLD_TRIGGER, lambda _: None)
    start(CLIENTS["rospy"], ros=ros)
    assert "service handler returned None" in ros.namespace["said"]


def test_ros2_service_refuses_none(start: Start) -> None:
    ros = start("pass")
    ros.bus.serve("dock", TRIGGER, lambda _: None)
    with pytest.raises(RecordingError, match=r"handler of /dock must be of type .*, not None"):
        start(CLIENTS["rclpy"], ros=ros)


@pytest.mark.parametrize("node", SERVERS)
def test_a_request_of_another_type_is_refused(start: Start, node: str) -> None:
    ros = start(SERVERS[node])
    for request, seen in NO_REQUEST.values():
        with pytest.raises(
            RecordingError, match=rf"^The request to /switch must be of type .*, {seen}: make"
        ):
            ros.bus.call("switch", request)
    for good in (SWITCH.Request(data=True), OLD_SWITCH._request_class(True)):
        assert ros.bus.call("switch", good).response.success is True


@pytest.mark.parametrize("node", CLIENTS)
def test_wrong_service_type_names_both_types(start: Start, node: str) -> None:
    ros = start("pass")
    ros.bus.serve("dock", SWITCH, lambda _: SWITCH.Response(success=True, message="on"))
    with pytest.raises(
        RecordingError,
        match=r"^/dock is served as std_srvs/SetBool, but node '/caller' calls it as std_srvs/Trigger\.$",
    ):
        start(CLIENTS[node], ros=ros)


@pytest.mark.parametrize("node", CLIENTS)
@pytest.mark.parametrize("made", [TRIGGER.Response(message="a"), OLD_TRIGGER._response_class(True, "a")])
@pytest.mark.parametrize("served", [TRIGGER, OLD_TRIGGER])
def test_responses_of_ros1_and_ros2_are_accepted(start: Start, node: str, made: Any, served: Any) -> None:
    ros = start("pass")
    ros.bus.serve("dock", served, lambda _: made)
    start(CLIENTS[node], ros=ros)
    assert ros.namespace["said"] == "a"


def test_offering_a_wrong_object_as_a_service_is_refused(start: Start) -> None:
    bus = start("pass").bus
    for wrong, seen in (
        (message_type("std_msgs/Float64"), "the class Float64"),
        ("std_srvs/srv/Trigger", "str"),
    ):
        with pytest.raises(
            RecordingError, match=rf"^tarl\.bus\.serve\('dock', …\): {seen} is not a service type"
        ):
            bus.serve("dock", wrong, lambda _: None)
    with pytest.raises(RecordingError, match="the handler None is not callable"):
        bus.serve("dock", TRIGGER, None)


def test_topic_name_must_be_a_string(start: Start) -> None:
    bus = start("pass").bus
    for call in (
        lambda: bus.publish(None, message_type("std_msgs/Float64")()),
        lambda: bus.latest(3),
        lambda: bus.subscribe(b"odom", print),
        lambda: bus.call(None, TRIGGER.Request()),
        lambda: bus.serve(None, TRIGGER, print),
    ):
        with pytest.raises(RecordingError, match=r"^The name of a topic or service must be a text, not "):
            call()
    with pytest.raises(RecordingError, match=r"^tarl\.bus\.subscribe\('odom', …\): None is not callable"):
        bus.subscribe("odom", None)


REFUSING = {
    "exception": ("def dock(request): raise ValueError('jammed')", "error processing request: jammed"),
    "None": ("def dock(request): pass", "service handler returned None"),
    "type": ("def dock(request): return TriggerResponse(True, 7)", "error processing request: "),
}
REFUSED = """
import rospy
from std_srvs.srv import Trigger, TriggerResponse
{}
rospy.init_node("server")
rospy.Service("dock", Trigger, dock)
rospy.spin()
"""


@pytest.mark.parametrize("reason", REFUSING)
def test_world_gets_a_sentence_for_a_refused_request(start: Start, reason: str) -> None:
    handler, said = REFUSING[reason]
    ros = start(REFUSED.format(handler))
    reply = ros.bus.call("dock", OLD_TRIGGER._request_class())
    assert reply.done
    assert said in reply.error
    with pytest.raises(RecordingError, match=rf"^/dock gave no response: .*{said}.*\.$"):
        _ = reply.response


def test_unanswered_reply_has_no_response(start: Start) -> None:
    ros = start(
        """
        import rospy
        from std_srvs.srv import Trigger, TriggerResponse
        def dock(request):
            rospy.sleep(1)
            return TriggerResponse(True, "docked")
        rospy.init_node("server")
        rospy.Service("dock", Trigger, dock)
        rospy.spin()
        """
    )
    reply = ros.bus.call("dock", OLD_TRIGGER._request_class())
    assert (reply.done, reply.response, reply.error) == (False, None, "")
    ros.step(1)
    assert (reply.done, reply.response.message, reply.error) == (True, "docked", "")


def test_ros2_client_gets_no_response_from_a_refusing_ros1_node(
    start: Start, caplog: pytest.LogCaptureFixture
) -> None:
    ros = start(REFUSED.format(REFUSING["exception"][0]))
    start(
        """
        import rclpy
        from pytest_tarl.ros import message_type
        Trigger = message_type("std_srvs/srv/Trigger")
        rclpy.init()
        node = rclpy.create_node("caller")
        future = node.create_client(Trigger, "dock").call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
        done = future.done()
        """,
        ros=ros,
    )
    ros.step(2)
    assert ros.namespace["done"] is False  # type: ignore[attr-defined]
    assert "/dock gave no response: error processing request: jammed" in caplog.text
