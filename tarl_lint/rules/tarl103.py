"""TARL103: a request influences the response of its own service or action server.

A service exists to answer its request, and an action server to reach its goal. A flow from a request to its own
response is therefore expected, and a workspace may have hundreds of such flows. For this reason, the rule is off by
default. Turn it on with `--extend-select TARL103`, or with `extend-select = ["TARL103"]` in the settings. A flow from a
request to a topic, or to the response of another service, is reported as TARL101 or TARL102.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.catalog import on_topic
from tarl_lint.model import Finding, Flow
from tarl_lint.rules.wording import end

CODE: Final = "TARL103"
SUMMARY: Final = "a request influences the response of its own service or action server"

INVALID: Final = (
    """
    import rospy
    from example_interfaces.srv import AddTwoInts, AddTwoIntsResponse

    def add(request):
        return AddTwoIntsResponse(request.a + request.b)

    rospy.Service("add", AddTwoInts, add)
    """,
)

VALID: Final = (
    """
    import rospy
    from std_msgs.msg import Float64
    from robot_msgs.srv import SetSpeed, SetSpeedResponse

    speed = rospy.Publisher("/speed", Float64, queue_size=1)

    def set_speed(request):
        speed.publish(request.speed)
        return SetSpeedResponse()

    rospy.Service("set_speed", SetSpeed, set_speed)
    """,
)


def own_response(flow: Flow) -> bool:
    """Return whether a flow leads from a request to the response of the same service or action server."""
    source, sink = flow.source, flow.sink
    if on_topic(source.api) or not sink.api.startswith(f"{source.api}."):
        return False
    # If the names of two servers of one type are unknown, the servers are distinguished by their request handlers.
    handled = source.topics or source.callback.rpartition(".")[2] == sink.qualname.rpartition(".")[2]
    return bool(handled) and (source.topics, source.type) == (sink.topics, sink.type)


def finding(flow: Flow) -> Finding:
    """Return the note for a flow, where the response is made."""
    return Finding(CODE, flow.sink.span, f"{end(flow.source)} reaches its own response", flow)
