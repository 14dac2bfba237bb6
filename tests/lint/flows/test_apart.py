"""Sources that a helper class registers at one line are told apart by their topics."""

from __future__ import annotations

import pytest

from tarl_lint.interpret.budget import MAX_APART
from tarl_lint.model import Flow
from tarl_lint.run.runner import run
from tarl_lint.settings.config import Config, Options
from tests.lint.analysing import analysed
from tests.lint.models.marked import flows

HELPER = """
import rospy
from std_msgs.msg import Bool, Float64

class Input:
    def __init__(self, name, kind):
        self.value = kind().data
        rospy.Subscriber(name, kind, self._cb)

    def _cb(self, msg):
        self.value = msg.data
"""


def ends(flows: tuple[Flow, ...]) -> set[tuple[str, tuple[str, ...], str]]:
    return {(flow.kind, flow.source.topics, ", ".join(flow.sink.topics)) for flow in flows}


def test_each_use_of_a_helper_class_has_its_own_type(tmp_path):
    node = HELPER + (
        "rospy.init_node('node')\n"
        "pub, log = rospy.Publisher('out', Float64), rospy.Publisher('log', Float64)\n"
        "level, stop = Input('level', Float64), Input('stop', Bool)\n"
        "while not rospy.is_shutdown():\n"
        "    if not stop.value:\n"
        "        pub.publish(level.value)\n"
        "    log.publish(level.value)\n"
    )
    flows = analysed(tmp_path, node=node).flows
    assert ends(flows) == {
        ("explicit", ("level",), "out"),
        ("implicit", ("stop",), "out"),
        ("explicit", ("level",), "log"),
    }
    assert {(*flow.source.topics, flow.source.type) for flow in flows} == {
        ("level", "Float64"),
        ("stop", "Bool"),
    }
    assert len({flow.source.span for flow in flows}) == 1


def test_two_uses_of_one_topic_are_one_source(tmp_path):
    node = HELPER + (
        "rospy.init_node('node')\n"
        "pub = rospy.Publisher('out', Float64)\n"
        "one, other = Input('level', Float64), Input('level', Float64)\n"
        "while not rospy.is_shutdown():\n"
        "    pub.publish(one.value + other.value)\n"
    )
    assert [flow.source.topics for flow in analysed(tmp_path, node=node).flows] == [("level",)]


@pytest.mark.parametrize(
    ("wanted", "topics"),
    [("(('left', double), ('right', half))", {("left",), ("right",)}),
     ("set([('left', double), ('right', half)])", {("left",), ("right",)})],
    ids=["in order", "in any order"],
)  # fmt: skip
def test_each_row_of_an_unrolled_loop_is_a_source(tmp_path, wanted, topics):
    node = (
        "import rospy\nfrom std_msgs.msg import Float64\n"
        "more, less = rospy.Publisher('more', Float64), rospy.Publisher('less', Float64)\n"
        "def double(msg):\n    more.publish(msg.data * 2)\n"
        "def half(msg):\n    less.publish(msg.data / 2)\n"
        f"subs = [rospy.Subscriber(name, Float64, heard) for name, heard in {wanted}]\n"
    )
    assert {flow.source.topics for flow in analysed(tmp_path, node=node).flows} == topics


def test_a_base_class_subscribes_for_its_subclasses(tmp_path):
    node = (
        "import rospy\nfrom std_msgs.msg import Float64\n"
        "class Base:\n"
        "    def __init__(self, name, topic='raw'):\n"
        "        self.pub = rospy.Publisher(name + '/out', Float64)\n"
        "        rospy.Subscriber(name + '/' + topic, Float64, self.heard)\n"
        "    def heard(self, msg):\n        raise NotImplementedError\n"
        "class Doubling(Base):\n"
        "    def heard(self, msg):\n        self.pub.publish(2 * msg.data)\n"
        "class Deciding(Base):\n"
        "    def heard(self, msg):\n        self.pub.publish(1.0 if msg.data > 0 else 0.0)\n"
        "def main():\n    Doubling('a')\n    Deciding('b', 'near')\n"
    )
    flows = analysed(tmp_path, node=node).flows
    assert {(kind, topics) for kind, topics, _ in ends(flows)} == {
        ("explicit", ("a/raw",)),
        ("implicit", ("b/near",)),
    }


def test_late_topic_name_adds_no_second_source(tmp_path):
    node = (
        "import rospy\nfrom std_msgs.msg import Float64\n"
        "class Node:\n"
        "    def __init__(self):\n"
        "        self.pub, self.name = rospy.Publisher('out', Float64), 'early'\n"
        "        rospy.Timer(rospy.Duration(1), self.connect)\n"
        "        rospy.Timer(rospy.Duration(1), self.choose)\n"
        "    def connect(self, event):\n        rospy.Subscriber(self.name, Float64, self.heard)\n"
        "    def choose(self, event):\n        self.name = 'late'\n"
        "    def heard(self, msg):\n        self.pub.publish(msg.data)\n"
        "Node()\n"
    )
    assert [flow.source.topics for flow in analysed(tmp_path, node=node).flows] == [("early", "late")]


def test_helper_with_an_unknown_topic_is_reported_once(tmp_path):
    node = HELPER + (
        "rospy.init_node('node')\n"
        "pub, log = rospy.Publisher('out', Float64), rospy.Publisher('log', Float64)\n"
        "level, chosen = Input('level', Float64), Input(rospy.get_param('~name'), Float64)\n"
        "while not rospy.is_shutdown():\n"
        "    pub.publish(level.value + chosen.value)\n"
        "    log.publish(chosen.value)\n"
    )
    assert ends(analysed(tmp_path, node=node).flows) == {
        ("explicit", ("level",), "out"),
        ("explicit", (), "log"),
    }


def test_line_with_many_subscriptions_has_one_source(tmp_path):
    names = [f"t{number}" for number in range(MAX_APART + 10)]
    node = (
        "import rospy\nfrom std_msgs.msg import Float64\n"
        "pub = rospy.Publisher('out', Float64)\n"
        "def hear(name):\n    rospy.Subscriber(name, Float64, lambda msg: pub.publish(msg.data))\n"
        + "".join(f"hear('{name}')\n" for name in names)
    )
    heard = [flow.source.topics for flow in analysed(tmp_path, node=node).flows]
    assert {name for topics in heard for name in topics} == set(names)
    assert len(heard) <= MAX_APART + 1


def test_fully_read_helper_has_no_unused_subscription(tmp_path):
    text = HELPER + "rospy.init_node('node')\nInput('level', Float64)\nprint(Input('stop', Bool).value)\n"
    (tmp_path / "node.py").write_text(text, encoding="utf-8")
    chosen = Config(root=tmp_path, select=("TARL203",))
    assert run(Options((tmp_path,), jobs=1, cache=False), chosen).findings == ()
    (tmp_path / "node.py").write_text(
        text.replace("print(Input('stop', Bool).value)", "Input('stop', Bool)"), "utf-8"
    )
    (found,) = run(Options((tmp_path,), jobs=1, cache=False), chosen).findings
    assert "level, stop" in found.message


TABLES = {
    "callbacks in a table": """
def on_a(msg):
    out.publish(msg.data)
def on_b(msg):
    other.publish(msg.data)
for topic, callback in (("a", on_a), ("b", on_b)):
    rospy.Subscriber(topic, Float64, callback)
""",
    "callbacks in a list, in a function": """
def on_a(msg):
    out.publish(msg.data)
def on_b(msg):
    other.publish(msg.data)
def main():
    for topic, callback in [("a", on_a), ("b", on_b)]:
        name = topic
        rospy.Subscriber(name, Float64, callback)
main()
""",
}


@pytest.mark.parametrize("body", TABLES.values(), ids=TABLES)
def test_subscriptions_in_a_loop_over_a_table_are_distinguished(body: str) -> None:
    head = "import rospy\nfrom std_msgs.msg import Float64\n"
    head += "".join(
        f'{name} = rospy.Publisher("{name}", Float64, queue_size=1)\n' for name in ("out", "other")
    )
    found = {(f.source.topics, f.sink.topics) for f in flows(head + body)}
    assert found == {(("a",), ("out",)), (("b",), ("other",))}


OUTPUT = """
import rospy
from std_msgs.msg import Float64

class Output:
    def __init__(self, name):
        self.pub = rospy.Publisher(name, Float64, queue_size=1)

    def send(self, value):
        self.pub.publish(Float64(value))

rospy.init_node("node")
"""


def pairs(text: str) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    return [(flow.source.topics, flow.sink.topics) for flow in flows(text)]


def test_publishers_of_a_helper_class_are_separate_sinks() -> None:
    text = OUTPUT + (
        "left, right = Output('left'), Output('right')\n"
        "rospy.Subscriber('a', Float64, lambda msg: left.send(msg.data))\n"
        "rospy.Subscriber('b', Float64, lambda msg: right.send(msg.data))\n"
    )
    assert pairs(text) == [(("a",), ("left",)), (("b",), ("right",))]
    assert len({flow.sink.span for flow in flows(text)}) == 1
    assert len({flow.sink.id for flow in flows(text)}) == 2


def test_two_publishers_with_one_topic_are_one_sink() -> None:
    text = OUTPUT + (
        "one, other = Output('out'), Output('out')\n"
        "rospy.Subscriber('a', Float64, lambda msg: one.send(msg.data))\n"
        "rospy.Subscriber('b', Float64, lambda msg: other.send(msg.data))\n"
    )
    assert pairs(text) == [(("a",), ("out",)), (("b",), ("out",))]


def test_publishers_that_get_the_same_messages_are_one_sink() -> None:
    text = OUTPUT + (
        "pubs = [rospy.Publisher(name, Float64) for name in ('left', 'right')]\n"
        "def on(msg):\n    for pub in pubs:\n        pub.publish(msg)\n"
        "rospy.Subscriber('a', Float64, on)\n"
    )
    assert pairs(text) == [(("a",), ("left", "right"))]


def test_publisher_chosen_by_data_depends_on_the_choice() -> None:
    text = OUTPUT + (
        "left, right = Output('left'), Output('right')\n"
        "rospy.Subscriber('a', Float64, lambda msg: (left if msg.data > 0 else right).send(1.0))\n"
    )
    assert {(flow.kind, flow.sink.topics) for flow in flows(text)} == {
        ("implicit", ("left",)),
        ("implicit", ("right",)),
    }


def test_known_and_unknown_topics_of_a_helper_have_separate_sinks() -> None:
    text = OUTPUT + (
        "known, chosen = Output('known'), Output(rospy.get_param('~name'))\n"
        "rospy.Subscriber('a', Float64, lambda msg: (known.send(msg.data), chosen.send(msg.data)))\n"
        "rospy.Subscriber('b', Float64, lambda msg: chosen.send(msg.data))\n"
    )
    assert pairs(text) == [(("a",), ("known",)), (("b",), ())]


def test_call_with_very_many_publishers_has_one_sink() -> None:
    names = [f"t{number}" for number in range(MAX_APART + 10)]
    uses = "".join(
        f"rospy.Subscriber('a', Float64, lambda msg: Output('{n}').send(msg.data))\n" for n in names
    )
    sent = [sink for _, sink in pairs(OUTPUT + uses)]
    assert {topic for topics in sent for topic in topics} == set(names)
    assert len({*sent}) == MAX_APART + 1
