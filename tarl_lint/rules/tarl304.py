"""TARL304: a service that is called has no server, and a server with a similar name is never called.

The client waits forever, or its calls fail. The reason is often a namespace or a private name: the service `~home` of
the node `arm` is `/arm/home`, not `/home`. If the launch file renames a node, its private services get other names,
too.

Names are similar under the conditions of TARL301. Two names in the same namespace, such as `/arm/open` and
`/arm/open_door`, are similar as well. In the root namespace, `dock` and `dock_robot` are similar only for service types
that few nodes offer, which excludes `Trigger`. Actions are compared in the same way as services.

If some nodes are unknown or a launch file is missing, the rule reports only misspelt names that no unknown node
mentions. An unknown sensor driver is disregarded unless it may offer a service of this type under one of the two names.
A laser driver may offer a `Trigger` named `start_motor`, but not one named `release`.

The rule reports nothing if no server has a similar name, because the server may be started elsewhere, as is usual for
drivers and controllers. The report of `--launch` lists such services under "No server here" and such actions under "No
action server here". The JSON report lists both under `one_sided`. They do not fail the run.
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
    """Yield a hazard for each client whose service or action has the same type as a server's but a different name."""
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
