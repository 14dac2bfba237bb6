"""TARL102: a subscribed topic decides what, or whether, a node publishes.

The publish call sends no data of the message, but a condition on the message chooses between constants, or between
publishing and not publishing (an *implicit* flow). A statement after a loop does not depend on the condition of the
loop. The arrival of a message does not count as a condition.

In rclpy, an action server calls its `execute_callback` only if its `goal_callback` accepts the goal. A condition in
`goal_callback` therefore decides what `execute_callback` publishes. So does a condition on the call of
`goal_handle.execute()` in the `handle_accepted_callback`.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.model import Finding, Flow
from tarl_lint.rules.wording import end

CODE: Final = "TARL102"
SUMMARY: Final = "a subscribed topic decides what, or whether, a node publishes"

INVALID: Final = (
    """
    import rospy
    from sensor_msgs.msg import Range
    from std_msgs.msg import Bool

    stop = rospy.Publisher("/stop", Bool, queue_size=1)

    def on_range(msg):
        if msg.range < 0.3:
            stop.publish(True)

    rospy.Subscriber("/range", Range, on_range)
    """,
)

VALID: Final = (
    """
    import rospy
    from sensor_msgs.msg import Range
    from std_msgs.msg import Bool

    alive = rospy.Publisher("/alive", Bool, queue_size=1)

    def on_range(msg):
        if msg.range < 0.3:
            rospy.loginfo("near")
        alive.publish(True)

    rospy.Subscriber("/range", Range, on_range)
    """,
)


def finding(flow: Flow) -> Finding:
    """Return the note for a flow, at its publish call."""
    return Finding(CODE, flow.sink.span, f"{end(flow.source)} decides on {end(flow.sink)}", flow)
