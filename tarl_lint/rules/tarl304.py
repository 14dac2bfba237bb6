"""TARL304: a service that is called has no server, and a server with a similar name is never called.

The client waits forever, or its calls fail. As with topics, a namespace or a private name is often the reason: a
service `~home` of the node `arm` is `/arm/home`, not `/home`. In one namespace, `open` and `open_door` are similar as
well. If the launch file gives a node another name than its code, the names of its private services change, too.

The rule reports nothing if a node of the launch file was not read and may use the type, or if an included launch file
is not in the workspace. The rule also reports nothing if no server has a similar name, because the server may be
started elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import (
    at_end,
    in_private_names,
    longer_alike,
    single,
    spelled_alike,
    under_own_name,
)
from tarl_lint.system.model import System
from tarl_lint.workspace.conditions import exclusive

CODE: Final = "TARL304"
SUMMARY: Final = "a service that is called has no server, and a server with a similar name is never called"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="arm.py" name="arm"/>
      <node pkg="robot" type="client.py" name="client"/>
    </launch>
    --- scripts/arm.py
    import rospy
    from std_srvs.srv import Trigger, TriggerResponse

    rospy.init_node("arm")
    rospy.Service("~home", Trigger, lambda request: TriggerResponse(True, ""))
    rospy.spin()
    --- scripts/client.py
    import rospy
    from std_srvs.srv import Trigger

    rospy.init_node("client")
    rospy.wait_for_service("home")
    rospy.ServiceProxy("home", Trigger)()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="arm.py" name="arm"/>
      <node pkg="robot" type="client.py" name="client"/>
    </launch>
    --- scripts/arm.py
    import rospy
    from std_srvs.srv import Trigger, TriggerResponse

    rospy.init_node("arm")
    rospy.Service("~home", Trigger, lambda request: TriggerResponse(True, ""))
    rospy.spin()
    --- scripts/client.py
    import rospy
    from std_srvs.srv import Trigger

    rospy.init_node("client")
    rospy.wait_for_service("arm/home")
    rospy.ServiceProxy("arm/home", Trigger)()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each client whose service differs from that of a server only in its name."""
    served, called = ({name for name, _, _ in system.named(role)} for role in ("serves", "calls"))
    for name, who, end in system.ends("calls"):
        near = sorted(
            (other, them.name, under_own_name(name, other, them))
            for other, them, beyond in system.ends("serves")
            if other not in called
            and single(beyond) == single(end)
            and (
                spelled_alike(name, other)
                or longer_alike(name, other)
                or in_private_names(name, other, who, them)
                or under_own_name(name, other, them)
            )
            and not exclusive(who.node, them.node)
        )
        # only the node itself offers its private names, and this node was read
        own = [one for one in near if one[1] == name.rpartition("/")[0] or one[2]]
        near = near if system.complete(end) else own
        if name not in served and near and single(end):
            message = f"{who.name} calls {name} ({end.type}), which no node offers; "
            message += " and ".join(f"{node} offers {other}" for other, node, _ in near)
            yield at_end(CODE, who, end, message, topic_text(end.in_code))
