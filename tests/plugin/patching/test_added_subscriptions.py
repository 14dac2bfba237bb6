"""Subscriptions that a condition needs have the right place and text, and the node runs with them."""

from __future__ import annotations

from dataclasses import replace
from textwrap import dedent
from types import SimpleNamespace

import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from tarl_lint.model import SiteId, Step
from tests.plugin.patching.repairs import (
    MUD,
    POSITION,
    TERRAIN,
    TOPICS,
    HandMade,
    TinyRos,
    odometry,
    subscribing,
    terrain,
)
from tests.plugin.patching.subscribed_nodes import NODES, PATCHED_SCRIPT, ROSPY_CLASS, SCRIPT, repaired


@pytest.mark.parametrize("kind", NODES)
def test_node_subscribes_in_its_own_style(kind: str) -> None:
    text, expected, call, api = NODES[kind]
    sources = {"node.py": text}
    assert repaired(sources, subscribing(sources, "node.py", call, api))["node.py"] == expected


@pytest.mark.parametrize("kind", NODES)
def test_patched_node_changes_under_the_condition(kind: str) -> None:
    text, _, call, api = NODES[kind]
    sources = {"node.py": text}
    ros = TinyRos()
    space = ros.run(repaired(sources, subscribing(sources, "node.py", call, api)), "node.py")

    def drive() -> None:
        ros.deliver("/odom", odometry(1.0))
        if "step" in space:
            space["step"](space["pub"])

    drive()
    ros.deliver("/terrain", terrain(True))
    drive()
    ros.deliver("/terrain", terrain(False))
    drive()
    assert ros.published == [5.0, 12.0, 5.0]


def test_windows_line_endings_are_kept() -> None:
    sources = {"node.py": SCRIPT.replace("\n", "\r\n")}
    flows = subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    assert repaired(sources, flows)["node.py"] == PATCHED_SCRIPT.replace("\n", "\r\n")


def test_node_start_is_used_without_a_subscription() -> None:
    for name, (text, _, call, _) in NODES.items():
        ros = TinyRos()
        ros.run(repaired({"node.py": text.replace(call, "None")}), "node.py")
        assert list(ros.subscribed) == ["/terrain"], name


def test_reading_loop_subscribes_before_the_loop() -> None:
    text = dedent(
        """\
        import rospy
        from nav_msgs.msg import Odometry
        rospy.init_node("n")
        pub = rospy.Publisher("/vel", Odometry, queue_size=1)
        while not rospy.is_shutdown():
            msg = rospy.wait_for_message("/odom", Odometry)
            pub.publish(5 * msg.x)
        """
    )
    sources = {"node.py": text}
    flows = subscribing(
        sources, "node.py", 'rospy.wait_for_message("/odom", Odometry)', "rospy.wait_for_message"
    )
    changed = repaired(sources, flows)["node.py"]
    assert '\nrospy.init_node("n")\nrospy.Subscriber("/terrain", Bool, on_terrain)\npub =' in changed
    assert "import Odometry\nfrom std_msgs.msg import Bool\n" in changed
    ros = TinyRos()
    ros.run({"node.py": changed}, "node.py")
    assert list(ros.subscribed) == ["/terrain"]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            "    for topic in topics:\n        rospy.Subscriber(topic, O, cb)\n",
            '    rospy.Subscriber("/terrain", Bool, on_terrain)\n    for topic in topics:\n',
        ),
        (
            "    init(); rospy.Subscriber(topic, O, cb); rospy.spin()\n",
            '    rospy.Subscriber("/terrain", Bool, on_terrain)\n    init(); ',
        ),
        (
            "    if go: rospy.Subscriber(topic, O, cb)\n",
            '    rospy.Subscriber("/terrain", Bool, on_terrain)\n    if go: ',
        ),
        (
            "    return rospy.Subscriber(topic, O, cb)\n",
            '    rospy.Subscriber("/terrain", Bool, on_terrain)\n    return rospy',
        ),
        (
            "    subs = [\n        rospy.Subscriber(topic, O, cb),  # all\n    ]  # of them\n    rospy.spin()\n",
            '    ]  # of them\n    rospy.Subscriber("/terrain", Bool, on_terrain)\n    rospy.spin()\n',
        ),
        (
            "    try:\n        rospy.Subscriber(topic, O, cb)\n    finally:\n        pass\n",
            'topic, O, cb)\n        rospy.Subscriber("/terrain", Bool, on_terrain)\n    finally:',
        ),
    ],
)
def test_the_subscription_is_made_once_and_before_anything_blocks(body: str, expected: str) -> None:
    sources = {
        "node.py": f"import rospy\n\ndef main(topics, topic, O, cb):\n{body}\n\ndef step(d):\n    return 5 * d\n"
    }
    flows = subscribing(sources, "node.py", "rospy.Subscriber(topic, O, cb)", "rospy.Subscriber")
    assert expected in repaired(sources, flows)["node.py"]


@pytest.mark.parametrize(
    ("imports", "written", "subscriber", "kind"),
    [
        ("import rospy as ros", "import rospy as ros\nfrom std_msgs.msg import Bool\n", "ros.Subscriber", "Bool"),
        (
            "from rospy import Subscriber, Publisher\nimport std_msgs.msg as sm",
            "from rospy import Subscriber, Publisher\nimport std_msgs.msg as sm\n", "Subscriber", "sm.Bool",
        ),
        (
            "import rospy\nfrom std_msgs.msg import *", "import rospy\nfrom std_msgs.msg import *\n",
            "rospy.Subscriber", "Bool",
        ),
        (
            "import rospy\nfrom std_msgs.msg import Bool as B", "import rospy\nfrom std_msgs.msg import Bool as B\n",
            "rospy.Subscriber", "B",
        ),
        (
            "import rospy\nfrom mine import Bool",
            "from mine import Bool\nfrom std_msgs.msg import Bool as BoolMessage\n",
            "rospy.Subscriber", "BoolMessage",
        ),
        (
            "import rospy\nfrom a_msgs.msg import A\nfrom z_msgs.msg import Z",
            "from a_msgs.msg import A\nfrom std_msgs.msg import Bool\nfrom z_msgs.msg import Z\n",
            "rospy.Subscriber", "Bool",
        ),
        (
            "import rospy\nfrom z_msgs.msg import Z", "from std_msgs.msg import Bool\nfrom z_msgs.msg import Z\n",
            "rospy.Subscriber", "Bool",
        ),
        (
            "import rospy\nfrom std_msgs.msg import (\n    Float64,\n    String)",
            "from std_msgs.msg import (\n    Bool,\n    Float64,\n    String)\n", "rospy.Subscriber", "Bool",
        ),
        (
            "import rospy\nfrom std_msgs.msg import Z, A  # both", "from std_msgs.msg import Z, A, Bool  # both\n",
            "rospy.Subscriber", "Bool",
        ),
        (
            "try:\n    import rospy\nexcept ImportError:\n    rospy = None",
            "from std_msgs.msg import Bool\n\ntry:\n    import rospy\n", "rospy.Subscriber", "Bool",
        ),
    ],
)  # fmt: skip
def test_type_import_is_added_beside_others(imports: str, written: str, subscriber: str, kind: str) -> None:
    sources = {
        "node.py": f"{imports}\n\nA = Z = 1\n\n\ndef main(O, cb):\n    listen('/odom', O, cb)\n\n\ny = 5 * A\n"
    }
    flows = subscribing(sources, "node.py", "listen('/odom', O, cb)", "rospy.Subscriber")
    changed = repaired(sources, flows)["node.py"]
    assert written in changed
    assert f"    {subscriber}('/terrain', {kind}, on_terrain)\n" in changed


def test_names_that_the_file_uses_are_not_reused() -> None:
    text = SCRIPT.replace("GAIN", "terrain").replace("def step(pub)", "def step(pub, on_terrain_reading=0)")
    sources = {"node.py": text}
    changed = repaired(
        sources, subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    )["node.py"]
    assert "\nterrain_reading = None\n" in changed
    assert "def on_terrain_reading_reading(message):\n    global terrain_reading\n" in changed
    assert "    if terrain_reading:\n" in changed


@pytest.mark.parametrize("name", ["list", "class", "message"])
def test_builtin_and_parameter_names_are_not_reused(name: str) -> None:
    sensor = Sensor(name, topic="/terrain", field="data")
    sources = {"node.py": SCRIPT}
    flows = subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    changed = repaired(sources, flows, Guard((Conjunct(sensor, 1, 1),)))
    ros = TinyRos()
    space = ros.run(changed, "node.py")
    ros.deliver("/odom", odometry(1.0))
    ros.deliver("/terrain", terrain(True))
    space["step"](space["pub"])
    assert ros.published == [12.0]
    assert space.get("list") is None


@pytest.mark.parametrize("name", ["context", "executor", "on_odom", "pub"])
def test_names_of_attributes_of_the_node_are_not_reused(name: str) -> None:
    sensor = Sensor(name, topic="/terrain", field="data")
    text, _, call, api = NODES["rclpy class"]
    sources = {"node.py": text}
    changed = repaired(sources, subscribing(sources, "node.py", call, api), Guard((Conjunct(sensor, 1, 1),)))
    assert f"self.{name}_reading = message.data" in changed["node.py"]


def test_two_sensors_of_a_topic_share_a_subscription() -> None:
    front = Sensor("front", topic="/scan", field="ranges.0", low=0, high=5, bins=5)
    back = Sensor("back", topic="/scan", field="ranges.-1", low=0, high=5, bins=5)
    sources = {"node.py": SCRIPT}
    flows = subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    changed = repaired(sources, flows, Guard((Conjunct(front, 0, 1), Conjunct(back, 2, 5))))
    assert (
        "    if front is not None and 0.0 <= front < 1.0 and back is not None and 2.0 <= back <= 5.0:\n"
        in changed["node.py"]
    )
    assert changed["node.py"].count("rospy.Subscriber") == 2
    ros = TinyRos()
    space = ros.run(changed, "node.py")
    ros.deliver("/odom", odometry(1.0))
    for ranges in ([], [0.5, 3.0], [3.0, 0.5]):
        ros.deliver("/scan", SimpleNamespace(ranges=ranges))
        space["step"](space["pub"])
    assert ros.published == [5.0, 12.0, 5.0]


def test_available_sensor_needs_no_subscription() -> None:
    sources = {"node.py": SCRIPT}
    held = {("/odom", "pose.pose.position.x"): ("pos",)}
    changed = repaired(sources, guard=Guard((Conjunct(POSITION, 4.0, 7.0),)), held=held)["node.py"]
    assert "    if 4.0 <= pos < 7.0:\n" in changed
    assert changed.count("rospy.Subscriber") == 1


LIBRARY = """\
class Controller:
    def command(self, error):
        return 5 * error
"""


@pytest.mark.parametrize(
    ("importing", "target"),
    [
        ("from control import Controller", "on_terrain"),
        ("import control\nController = control.Controller", "control.on_terrain"),
        ("import control as c\nController = c.Controller", "c.on_terrain"),
    ],
)
def test_value_used_elsewhere_is_stored_there(importing: str, target: str) -> None:
    main = SCRIPT.replace("import rospy\n", f"import rospy\n{importing}\n").replace(
        "5 * pos", "Controller().command(pos)"
    )
    sources = {"control.py": LIBRARY, "node.py": main}
    changed = repaired(sources, subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber"))
    assert f'    rospy.Subscriber("/terrain", Bool, {target})\n' in changed["node.py"]
    ros = TinyRos()
    space = ros.run(changed, "node.py")
    ros.deliver("/odom", odometry(1.0))
    for value in (True, False):
        ros.deliver("/terrain", terrain(value))
        space["step"](space["pub"])
    assert ros.published == [12.0, 5.0]


def test_patch_subscribes_in_an_indirectly_imported_class() -> None:
    library = LIBRARY.replace(
        "class Controller:\n",
        'class Controller:\n    def __init__(self):\n        """Be ready."""\n        self.on = True\n\n',
    )
    sources = {"control.py": library, "node.py": SCRIPT}
    changed = repaired(sources, subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber"))
    assert changed["node.py"] == SCRIPT
    ros = TinyRos()
    controller = ros.run({"control.py": changed["control.py"]}, "control.py")["Controller"]
    with ros.installed():
        made = controller()
    assert made.command(1.0) == 5.0
    ros.deliver("/terrain", terrain(True))
    assert made.command(1.0) == 12.0


def test_a_value_that_cannot_reach_its_use_is_refused() -> None:
    sources = {"control.py": LIBRARY, "node.py": SCRIPT}
    with pytest.raises(RepairError, match=r"imports nothing from control\.py"):
        repaired(sources, subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber"))


def test_a_node_that_never_starts_is_refused() -> None:
    with pytest.raises(RepairError, match="no place was found where the node subscribes or starts"):
        repaired({"node.py": "def step(d):\n    return 5 * d\n"})


@pytest.mark.parametrize("topics", [{}, {"/terrain": "Stub"}])
def test_a_topic_of_unknown_type_is_refused(topics: dict[str, str]) -> None:
    with pytest.raises(RepairError, match="the run did not show the type of its messages"):
        repaired({"node.py": SCRIPT}, topics=topics)


def test_sensor_is_stored_for_a_method_and_a_function() -> None:
    text = ROSPY_CLASS.replace("driver = Driver()", "def step(d):\n    return 7 * d\n\n\ndriver = Driver()")
    sources = {"node.py": text}
    analysis = HandMade(sources, subscribing(sources, "node.py", NODES["rospy class"][2], "rospy.Subscriber"))
    changes = [Mutation(analysis.operand(code, int(code), f"{code} *"), 12.0) for code in "57"]
    changed = rewrite(analysis, changes, Guard((Conjunct(TERRAIN, 1, 1),)), TOPICS)["node.py"]
    assert "        if self.terrain:\n" in changed
    assert "    if terrain:\n        return 12.0 * d\n    return 7 * d\n" in changed
    ros = TinyRos()
    space = ros.run({"node.py": changed}, "node.py")
    ros.deliver("/terrain", terrain(True))
    ros.deliver("/odom", odometry(1.0))
    assert [space["step"](1.0), *ros.published] == [12.0, 12.0]


@pytest.mark.parametrize("early", ["self.gain = 5 * 1.0", "self.gain = self.compute()"])
def test_an_attribute_is_set_before_the_constructor_reads_it(early: str) -> None:
    text = ROSPY_CLASS.replace("        self.pub =", f"        {early}\n        self.pub =")
    text = text.replace("publish(5 * ", "publish(self.gain * ")
    if "compute" in early:
        text = text.replace(
            "    def on_odom", "    def compute(self):\n        return 5 * 1.0\n\n    def on_odom"
        )
    sources = {"node.py": text}
    flows = subscribing(sources, "node.py", NODES["rospy class"][2], "rospy.Subscriber")
    ros = TinyRos()
    assert ros.run(repaired(sources, flows), "node.py")["driver"].gain == 5.0


def test_late_subscribing_class_gets_a_class_attribute() -> None:
    text = ROSPY_CLASS.replace(
        "self.sub = rospy.Sub", "self.connect()\n\n    def connect(self):\n        self.sub = rospy.Sub"
    )
    sources = {"node.py": text}
    flows = subscribing(sources, "node.py", NODES["rospy class"][2], "rospy.Subscriber")
    changed = repaired(sources, flows)
    assert "class Driver:\n    terrain = None\n\n    def __init__" in changed["node.py"]
    ros = TinyRos()
    ros.run(changed, "node.py")
    ros.deliver("/odom", odometry(1.0))
    ros.deliver("/terrain", terrain(True))
    ros.deliver("/odom", odometry(1.0))
    assert ros.published == [5.0, 12.0]


def test_the_variables_for_several_topics_are_defined_together() -> None:
    front = Sensor("front", topic="/scan", field="angle_min", low=0, high=5, bins=5)
    sources = {"node.py": SCRIPT}
    flows = subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    guard = Guard((Conjunct(TERRAIN, 1, 1), Conjunct(front, 0, 1)))
    changed = repaired(sources, flows, guard)["node.py"]
    assert "pos = None\nterrain = None\nfront = None\n\n\ndef on_terrain(message):\n" in changed
    assert "    terrain = message.data\n\n\ndef on_front(message):\n" in changed
    assert 'on_terrain)\n    rospy.Subscriber("/scan", LaserScan, on_front)\n' in changed


def test_a_method_added_between_methods_keeps_their_spacing() -> None:
    sources = {"node.py": ROSPY_CLASS.replace("\n\n    def on_odom", "\n    def on_odom")}
    flows = subscribing(sources, "node.py", NODES["rospy class"][2], "rospy.Subscriber")
    assert "message.data\n\n    def on_odom" in repaired(sources, flows)["node.py"]


WRAPPED = """\
import rclpy
from nav_msgs.msg import Odometry


class Helper:
    def __init__(self, node):
        self.node = node
        self.x = 0.0
        self.listen("/odom", self.on_odom)

    def listen(self, topic, callback):
        return self.node.create_subscription(Odometry, topic, callback, 10)

    def on_odom(self, msg):
        self.x = 5 * msg.pose.pose.position.x


rclpy.init()
helper = Helper(rclpy.create_node("helper"))
"""


def test_a_node_that_uses_a_wrapper_subscribes_once() -> None:
    sources = {"node.py": WRAPPED}
    call = 'self.listen("/odom", self.on_odom)'
    changed = repaired(sources, subscribing(sources, "node.py", call, "rclpy"))
    assert (
        f'{call}\n        self.node.create_subscription(Bool, "/terrain", self.on_terrain, 10)\n'
        in changed["node.py"]
    )
    ros = TinyRos()
    helper = ros.run(changed, "node.py")["helper"]
    ros.deliver("/terrain", terrain(True))
    ros.deliver("/odom", odometry(1.0))
    assert helper.x == 12.0


def test_the_flow_of_the_site_decides_which_node_subscribes() -> None:
    other = "def other(O, cb):\n    rospy.Subscriber('/a', O, cb)\n\n\n"
    sources = {"node.py": SCRIPT.replace("# Keeps", f"{other}# Keeps")}
    foreign = subscribing(sources, "node.py", "rospy.Subscriber('/a', O, cb)", "rospy.Subscriber", "/a")
    (own,) = subscribing(sources, "node.py", NODES["rospy script"][2], "rospy.Subscriber")
    step = Step(SiteId("node", "", "5 *"), own.source.span, "", "publish", "data")
    changed = repaired(sources, (*foreign, replace(own, steps=(step,))))["node.py"]
    assert f'    {NODES["rospy script"][2]}\n    rospy.Subscriber("/terrain"' in changed


def test_two_modules_of_a_node_each_store_a_sensor() -> None:
    node = (
        "import rospy\nfrom driving import speed\nfrom nav_msgs.msg import Odometry\nfrom steering import turn\n\n"
        "sent = []\n\n\ndef callback(msg):\n    sent.append((turn(msg), speed(msg)))\n\n\n"
        'rospy.Subscriber("/odom", Odometry, callback)\n'
    )
    helpers = {
        "steering.py": "def turn(msg):\n    return 5 * msg.pose.pose.position.x\n",
        "driving.py": "def speed(msg):\n    return 3 * msg.pose.pose.position.x\n",
    }
    sources = {**helpers, "node.py": node}
    analysis = HandMade(
        sources,
        subscribing(sources, "node.py", 'rospy.Subscriber("/odom", Odometry, callback)', "rospy.Subscriber"),
    )
    edits = [
        Mutation(analysis.operand("5", 5, "5 *"), 12.0),
        Mutation(analysis.operand("3", 3, "3 *", "driving.py"), 7.0),
    ]
    ros = TinyRos()
    space = ros.run({**sources, **rewrite(analysis, edits, MUD, TOPICS)}, "node.py")
    ros.deliver("/odom", odometry(1.0))
    ros.deliver("/terrain", terrain(True))
    ros.deliver("/odom", odometry(1.0))
    assert space["sent"] == [(5.0, 3.0), (12.0, 7.0)]
