"""The taint list is complete, ordered and minimal."""

from textwrap import dedent

import pytest

from tests.lint.analysing import analysed, steps

FERRY = """
    import rospy
    from nav_msgs.msg import Odometry
    from std_msgs.msg import Float64

    place = 0.0
    SLACK = 0.05

    def arrived(data):
        global place
        place = data.pose.pose.position.y

    def ferry(bank, motor):
        gap = 1.0
        while gap > SLACK:
            way = bank - place
            gap = abs(way)
            push = 3 * way
            motor.publish(push)

    if __name__ == "__main__":
        rospy.init_node("ferry")
        rospy.Subscriber("/gps", Odometry, arrived)
        engine = rospy.Publisher("/engine", Float64, queue_size=1)
        while not rospy.is_shutdown():
            ferry(8.0, engine)
            ferry(-8.0, engine)
"""


def test_script_node_has_the_taint_list_of_the_paper(tmp_path):
    (flow,) = analysed(tmp_path, ferry=FERRY).flows
    assert flow.kind == "explicit"
    assert (flow.source.topics, flow.source.type, flow.source.callback) == (("/gps",), "Odometry", "arrived")
    assert (flow.sink.topics, flow.sink.type) == (("/engine",), "Float64")
    assert [(s.dependence, s.role, s.code) for s in flow.steps] == [
        ("context", "condition", 'if __name__ == "__main__":'),
        ("context", "register", 'rospy.Subscriber("/gps", Odometry, arrived)'),
        ("data", "receive", "def arrived(data):"),
        ("data", "assign", "place = data.pose.pose.position.y"),
        ("context", "condition", "while not rospy.is_shutdown():"),
        ("control", "condition", "while gap > SLACK:"),
        ("data", "assign", "way = bank - place"),
        ("control", "assign", "gap = abs(way)"),
        ("data", "assign", "push = 3 * way"),
        ("data", "publish", "motor.publish(push)"),
    ]


def test_moved_statements_keep_their_identity(tmp_path):
    before = analysed(tmp_path, ferry=FERRY).flows[0]
    after = analysed(tmp_path, ferry="\n\n# moved\n" + dedent(FERRY)).flows[0]
    assert [s.site for s in before.steps] == [s.site for s in after.steps]
    assert [s.span.line for s in before.steps] != [s.span.line for s in after.steps]


def test_statements_with_equal_text_are_numbered(tmp_path):
    (flow,) = analysed(
        tmp_path,
        node="""
        import rospy
        def on(msg):
            x = msg.data
            x = x + 1
            x = x + 1
            out.publish(x)
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
    ).flows
    assert [(s.site.text, s.site.ordinal, s.site.qualname) for s in flow.steps[2:5]] == [
        ("x = msg.data", 0, "on"),
        ("x = x + 1", 0, "on"),
        ("x = x + 1", 1, "on"),
    ]


def test_columns_count_characters(tmp_path):
    (flow,) = analysed(
        tmp_path,
        node="""
        import rospy
        out = rospy.Publisher("b", F)
        rospy.Subscriber("größe", F, lambda größe: out.publish(größe.data))
        """,
    ).flows
    body = next(s for s in flow.steps if s.role == "publish")
    assert body.code == "out.publish(größe.data)"
    assert body.site.qualname == "<lambda>"
    assert flow.source.topics == ("größe",)


@pytest.mark.parametrize(
    ("body", "data", "control"),
    [
        pytest.param(
            """
            scaled = helper(msg.data)
            out.publish(scaled)
            """,
            [
                "def on(msg):",
                "scaled = helper(msg.data)",
                "half = value / 2",
                "return half",
                "out.publish(scaled)",
            ],
            [],
            id="a helper's statements lie between the call and its result",
        ),
        pytest.param(
            """
            cmd = Twist()
            cmd.linear.x = msg.data
            cmd.angular.z = 0.5
            out.publish(cmd)
            """,
            ["def on(msg):", "cmd.linear.x = msg.data", "out.publish(cmd)"],
            [],
            id="other fields are left out",
        ),
        pytest.param(
            """
            cmd = build(msg.data)
            same = cmd
            out.publish(same)
            """,
            [
                "def on(msg):",
                "cmd = build(msg.data)",
                "cmd.linear.x = x",
                "return cmd",
                "same = cmd",
                "out.publish(same)",
            ],
            [],
            id="who passes the message on is on the way",
        ),
        pytest.param(
            """
            speed = 0.1
            if msg.data > limit:
                speed = 0.9
            out.publish(speed)
            """,
            [],
            ["def on(msg):", "if msg.data > limit:", "speed = 0.9", "out.publish(speed)"],
            id="a chosen constant is a control step",
        ),
        pytest.param(
            """
            if msg.data > limit:
                speed = 0.9
                out.publish(speed)
            """,
            [],
            ["def on(msg):", "if msg.data > limit:", "out.publish(speed)"],
            id="a constant under the same condition as its use is not chosen",
        ),
        pytest.param(
            """
            if msg.data > limit:
                send()
            """,
            [],
            ["def on(msg):", "if msg.data > limit:", "send()", "out.publish(1.0)"],
            id="a callee inherits the condition of its call",
        ),
        pytest.param(
            """
            for value in msg.data:
                out.publish(value)
            """,
            ["def on(msg):", "for value in msg.data:", "out.publish(value)"],
            [],
            id="a loop over data hands it on",
        ),
    ],
)
def test_steps_are_the_statements_on_the_path(tmp_path, body, data, control):
    text = f"""
import rospy
from geometry_msgs.msg import Twist
limit = 2.0
def helper(value):
    half = value / 2
    other = value * 3
    return half
def build(x):
    cmd = Twist()
    cmd.linear.x = x
    return cmd
def send():
    out.publish(1.0)
def on(msg):
{body.rstrip()}
out = rospy.Publisher("b", F)
rospy.Subscriber("a", F, on)
"""
    text = text.replace("\n            ", "\n    ")
    found = {f.sink.span.line: f for f in analysed(tmp_path, node=text).flows}
    assert len(found) == 1
    (flow,) = found.values()
    order = [*data, *control]
    assert sorted(steps(flow, "data"), key=order.index) == data
    assert steps(flow, "control") == control


def test_context_includes_the_callers_of_a_step(tmp_path):
    (flow,) = analysed(
        tmp_path,
        node="""
        import rospy
        class Node:
            def __init__(self):
                self.v = 0.0
                self.out = rospy.Publisher("b", F)
                self.sub = rospy.Subscriber("a", F, self.on)
            def on(self, msg):
                self.v = msg.data
            def once(self):
                self.out.publish(self.v)
            def run(self):
                while not rospy.is_shutdown():
                    self.once()
                    rospy.sleep(1)
        if __name__ == "__main__":
            Node().run()
        """,
    ).flows
    assert steps(flow, "context") == [
        'if __name__ == "__main__":',
        'self.sub = rospy.Subscriber("a", F, self.on)',
        "while not rospy.is_shutdown():",
    ]
    assert steps(flow, "data") == ["def on(self, msg):", "self.v = msg.data", "self.out.publish(self.v)"]


def test_wrapper_is_named_by_the_call_with_the_callback(tmp_path):
    (flow,) = analysed(
        tmp_path,
        node="""
        import rospy
        def listen(topic, callback):
            return rospy.Subscriber(topic, F, callback)
        def on(msg):
            out.publish(msg.data)
        out = rospy.Publisher("b", F)
        listen("a", on)
        """,
    ).flows
    assert flow.source.span.line == 8
    assert [v.line for v in flow.source.via] == [4]
    assert flow.source.topics == ("a",)


def test_messages_of_synchronised_subscribers_are_distinguished(tmp_path):
    flows = analysed(
        tmp_path,
        node="""
        import rospy, message_filters
        def both(left, right):
            out.publish(right.data)
        out = rospy.Publisher("b", F)
        one = message_filters.Subscriber("left", F)
        two = message_filters.Subscriber("right", F)
        sync = message_filters.TimeSynchronizer([one, two], 10)
        sync.registerCallback(both)
        """,
    ).flows
    assert [f.source.topics for f in flows] == [("right",)]
    assert [s.line for s in flows[0].source.registered] == [8, 9]


SYNCHRONISED = """
import rospy, message_filters
def each(left, right, state=None):
    pub_left.publish(left.data)
    pub_right.publish(right.data)
    pub_state.publish(state.data)
pub_left, pub_right, pub_state = rospy.Publisher("a", F), rospy.Publisher("b", F), rospy.Publisher("c", F)
left, right = message_filters.Subscriber("left", F), message_filters.Subscriber("right", F)
state = message_filters.Subscriber("state", F)
{}
message_filters.TimeSynchronizer(fs=subs, queue_size=10).registerCallback(each)
"""


@pytest.mark.parametrize(
    ("made", "pairs"),
    [
        ("subs = [left, right]\nsubs.append(state)", "left a, right b, state c"),
        ("subs = [left, right]\nif rospy.get_param('~c'): subs.append(state)", "left a, right b, state c"),
        ("subs = []\nsubs.append(left)", "left a"),
        (  # the first subscriber may be missing
            "subs = [left]\nif rospy.get_param('~c'): subs.append(right)\nsubs.append(state)",
            "left a, right b, state b, state c",
        ),
        (
            "subs = []\nfor one in (left, right, state): subs.append(one)",
            "left a, right b, state c",
        ),
        (
            "subs = [right]\nfor one in rospy.get_param('~names'): subs.append(message_filters.Subscriber('left', F))",
            "left a, left b, left c, right a, right b, right c",
        ),
        (
            "subs = [left]\nsubs.insert(0, right)",
            "left a, left b, left c, right a, right b, right c",
        ),
    ],
)
def test_synchronised_subscribers_in_a_list_keep_their_positions(tmp_path, made, pairs):
    flows = analysed(tmp_path, node=SYNCHRONISED.format(made)).flows
    assert sorted({f"{f.source.topics[0]} {f.sink.topics[0]}" for f in flows}) == pairs.split(", ")


def test_two_runs_give_the_same_result(tmp_path):
    assert analysed(tmp_path, ferry=FERRY).flows == analysed(tmp_path, ferry=FERRY).flows


@pytest.mark.parametrize("key", ["msg.name", "msg.name + 'x'", "str(msg.name)"])
def test_store_under_a_chosen_key_is_a_step(tmp_path, key):
    node = f"""
        import rospy
        def on(msg):
            table = {{}}
            table[{key}] = 1.0
            for name in table:
                out.publish(name)
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """
    (flow,) = analysed(tmp_path, node=node).flows
    stores = [step.dependence for step in flow.steps if step.code.startswith("table[")]
    assert (flow.kind, stores) == ("explicit", ["data"])
