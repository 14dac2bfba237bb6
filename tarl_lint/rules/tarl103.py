"""TARL103: a request decides what its own service or action server answers.

A service exists to answer its request, and an action server to reach its goal, so a flow from a request to its own
response says nothing new; a workspace may hold hundreds of them. This rule is off until you ask for it:
`--extend-select TARL103`, or `extend-select = ["TARL103"]` in the settings. A request that reaches a topic, or the
response of another service, is TARL101 or TARL102 as ever.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.catalog import on_topic
from tarl_lint.model import Finding, Flow
from tarl_lint.rules.wording import end

CODE: Final = "TARL103"
SUMMARY: Final = "a request decides what its own service or action server answers"

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
    """Tell whether a flow leads from a request to the response of the same service or action server."""
    source, sink = flow.source, flow.sink
    if on_topic(source.api) or not sink.api.startswith(f"{source.api}."):
        return False
    # Two servers of one type whose names are unknown are told apart by what handles the request
    handled = source.topics or source.callback.rpartition(".")[2] == sink.qualname.rpartition(".")[2]
    return bool(handled) and (source.topics, source.type) == (sink.topics, sink.type)


def finding(flow: Flow) -> Finding:
    """Return the note for a flow, where the response is made."""
    return Finding(CODE, flow.sink.span, f"{end(flow.source)} reaches its own response", flow)
