"""TARL304: a service that is called has no server, and a server with a similar name is never called.

The client waits forever, or its calls fail. As with topics, a namespace or a private name is often the reason: a
service `~home` of the node `arm` is `/arm/home`, not `/home`. In one namespace, `open` and `open_door` are similar as
well. If the launch file gives a node another name than its code, the names of its private services change, too.

Actions are compared in the same way as services. In the root namespace, `dock` and `dock_robot` are similar only if
the type is not one that many nodes offer, such as `Trigger`.

Beside nodes that were not read, and with missing launch files, the rule reports only misspelt names that no such node
mentions, as TARL301 does. As there, the driver of a sensor counts only if it may use the type and one of the names: a
laser driver may offer a `Trigger` named `start_motor`, but none named `release`.

The rule reports nothing if no server has a similar name, because the server may be started elsewhere: with drivers and
controllers, it usually is. The report of `--launch` lists these services under "No server here", actions under "No
action server here", and JSON lists both under `one_sided`; they do not fail the run.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_end, single
from tarl_lint.system.lonely_ends import Lonely, near
from tarl_lint.system.model import Role, System

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


# role of a client → role of its server, and what the message says about both
_ROLES: Final[tuple[tuple[Role, Role, str, str], ...]] = (
    ("calls", "serves", "calls", "offers"),
    ("asks", "performs", "sends goals to", "performs"),
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each client whose service or action differs from that of a server only in its name."""
    for client, server, calls, offers in _ROLES:
        served, called = ({name for name, _, _ in system.named(role)} for role in (server, client))
        lonely = [Lonely(*one) for one in system.ends(server) if one[0] not in called]
        for name, who, end in system.ends(client):
            if name in served or not single(end):
                continue
            offered = [one for one in lonely if single(one.end) == single(end)]
            alike = near(system, Lonely(name, who, end), offered, longer=True)
            if alike:
                message = f"{who.name} {calls} {name} ({end.type}), which no node {offers}; "
                message += " and ".join(f"{one.node.name} {offers} {one.name}" for one in alike)
                yield at_end(CODE, who, end, message, topic_text(end.in_code))
