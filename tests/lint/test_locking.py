"""TARL201: state shared between threads, with and without the lock that guards it."""

from textwrap import dedent

import pytest

from tarl_lint.run.runner import run
from tarl_lint.settings.config import Config, Options
from tests.lint.hazardous import inside, lines

ROSPY = """
    import threading
    import rospy
    from std_msgs.msg import Float64
    class Node:
        def __init__(self):
            self.lock = threading.Lock()
            self.changed = threading.Condition(self.lock)
            self.value = 0.0
            self.pub = rospy.Publisher("/out", Float64, queue_size=1)
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            with self.lock:
                self.value = msg.data
        def on_timer(self, event):
{body}
        def send(self):
            self.pub.publish(self.value * self.value)
    Node()
    rospy.spin()
"""


RCLPY = """
    import threading
    import rclpy
    from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
    from rclpy.executors import {executor}
    from rclpy.node import Node
    from std_msgs.msg import Float64
    class Relay(Node):
        def __init__(self):
            super().__init__("relay")
            self.lock = threading.Lock()
            self.group = {group}()
            self.value = 0.0
            self.pub = self.create_publisher(Float64, "out", 1)
            self.create_subscription(Float64, "in", self.on_value, 1)
            self.create_timer(0.1, self.on_timer, callback_group={given})
        def on_value(self, msg):
            with self.lock:
                self.value = msg.data
        def on_timer(self):
            self.pub.publish(Float64(data=self.value * self.value))
    rclpy.init()
    executor = {executor}()
    executor.add_node(Relay())
    executor.spin()
"""


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("self.pub.publish(self.value)", 0),
        ("self.pub.publish(self.value - self.value / 2)", 1),
        ("value = self.value\nself.pub.publish(value - value / 2)", 0),
        ("self.value = 1.5 * event.last_duration", 0),
        ("self.value = 1.5\nwith self.lock:\n    self.pub.publish(self.value)", 1),
        ("self.value += 1.0", 1),
        ("self.send()", 1),
        ("with self.lock:\n    self.send()", 0),
        ("with self.changed:\n    self.pub.publish(self.value)", 0),
        ("self.lock.acquire()\ntry:\n    self.send()\nfinally:\n    self.lock.release()", 0),
        ("self.lock.acquire()\nself.lock.release()\nself.send()", 1),
        ("if self.value is None:\n    return", 0),
        ("if self.value == 0.5:\n    return\nwith self.lock:\n    self.send()", 0),
        ("if self.value == 0.5:\n    return\nself.pub.publish(1.0)", 0),
        ("with self.lock:\n    self.send()\nself.send()", 1),
        ("pass", 0),
    ],
)
def test_unlocked_access_to_state_of_callback_and_timer_is_reported(body, found):
    assert len(lines("TARL201", inside(ROSPY, body, 12))) == found


@pytest.mark.parametrize(
    ("executor", "group", "given", "found"),
    [
        ("MultiThreadedExecutor", "ReentrantCallbackGroup", "self.group", 1),
        ("MultiThreadedExecutor", "MutuallyExclusiveCallbackGroup", "self.group", 1),
        ("MultiThreadedExecutor", "ReentrantCallbackGroup", "None", 0),
        ("SingleThreadedExecutor", "ReentrantCallbackGroup", "self.group", 0),
    ],
)
def test_rclpy_callbacks_overlap_only_with_suitable_groups(executor, group, given, found):
    text = RCLPY.format(executor=executor, group=group, given=given)
    if given == "None":
        text = text.replace(", callback_group=None", "")
    assert len(lines("TARL201", text)) == found


def test_unlocked_read_in_a_thread_is_reported_in_rclpy():
    text = RCLPY.format(executor="SingleThreadedExecutor", group="ReentrantCallbackGroup", given="self.group")
    text = text.replace(
        "self.create_timer(0.1, self.on_timer, callback_group=self.group)",
        "threading.Thread(target=self.on_timer).start()",
    )
    assert len(lines("TARL201", text)) == 1


def test_unlocked_call_is_reported_if_others_lock():
    text = inside(ROSPY, "with self.lock:\n    self.send()\nself.send()", 12)
    (line,) = lines("TARL201", text)
    assert dedent(text).strip("\n").split("\n")[line - 1].strip() == "self.send()"
    assert "on_timer" in dedent(text).strip("\n").split("\n")[line - 4]


def test_unlocked_container_access_is_reported():
    text = inside(ROSPY, "self.store.append(2.0)", 12).replace("self.value = msg.data", "self.store.clear()")
    for made, found in (("[]", 1), ("deque()", 1), ("Store()", 0), ("store", 0)):
        assert len(lines("TARL201", text.replace("self.value = 0.0", f"self.store = {made}"))) == found


GLOBAL = """
    import threading
    import rospy
    from std_msgs.msg import Float64
    lock = threading.Lock()
    value = 0.0
    values = []
    pub = rospy.Publisher("/out", Float64, queue_size=1)
    def on_value(msg):
        global value
        with lock:
            value = msg.data
            values.append(msg.data)
    def on_timer(event):
{body}
    rospy.Subscriber("/in", Float64, on_value)
    rospy.Timer(rospy.Duration(0.1), on_timer)
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("pub.publish(value)", 0),
        ("pub.publish(value * value)", 1),
        ("pub.publish(len(values))", 0),
        ("pub.publish(sum(values))", 1),
        ("with lock:\n    pub.publish(value)", 0),
        ("value = 1.0\npub.publish(value)", 0),
        ("pub.publish(1.0)", 0),
    ],
)
def test_unlocked_access_to_a_global_is_reported(body, found):
    assert len(lines("TARL201", inside(GLOBAL, body, 8))) == found


def test_access_without_any_lock_is_not_reported():
    flag = inside(ROSPY, "self.pub.publish(self.value)", 12).replace(
        "self.value = msg.data", "self.value = True"
    )
    assert lines("TARL201", flag) == []
    bare = inside(ROSPY, "self.pub.publish(self.value)", 12).replace("with self.lock:", "if msg.data:")
    assert lines("TARL201", bare) == []


TWO_PARTS = """
    import threading
    import rospy
    from std_msgs.msg import Float64
    class Node:
        def __init__(self):
            self.lock = threading.Lock()
            self.x = self.y = 0.0
            self.pub = rospy.Publisher("/out", Float64, queue_size=1)
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            with self.lock:
{written}
        def on_timer(self, event):
            self.pub.publish(self.x + self.y)
    Node()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("written", "found"),
    [("self.x = msg.data\nself.y = 2.0 * msg.data", 2), ("self.x = msg.data", 0)],
)
def test_reading_several_values_without_the_lock_is_reported(written, found):
    body = "\n".join(f"{' ' * 16}{line}" for line in written.split("\n"))
    assert len(lines("TARL201", TWO_PARTS.format(written=body))) == found


def test_access_in_a_function_called_by_ros_is_reported(tmp_path):
    """A callback run by ROS without the lock has no calling line; no line of another file may be reported."""
    files = {
        "a_first.py": "import rospy\n\n\ndef name():\n    return 'x'\n",
        "node.py": """
            import threading
            import rospy
            from std_msgs.msg import Float64
            from a_first import name
            class Node:
                def __init__(self):
                    self.lock = threading.Lock()
                    self.values = []
                    self.pub = rospy.Publisher("/out", Float64, queue_size=1)
                    rospy.Subscriber("/" + name(), Float64, self.keep)
                    rospy.Subscriber("/other", Float64, self.on_other)
                def keep(self, msg):
                    self.values.append(msg.data)
                def on_other(self, msg):
                    with self.lock:
                        self.keep(msg)
                        self.pub.publish(sum(self.values))
            Node()
            rospy.spin()
        """,
    }
    for file, text in files.items():
        (tmp_path / file).write_text(dedent(text))
    result = run(Options(paths=(tmp_path,), cache=False), Config(root=tmp_path, select=("TARL201",)))
    (finding,) = result.findings
    assert (finding.span.path.rpartition("/")[2], finding.span.line) == ("node.py", 14)


@pytest.mark.parametrize(("other", "count"), [("else", 0), ("if True", 1)])
def test_callbacks_registered_in_opposite_branches_do_not_race(tmp_path, other, count):
    """A node that either synchronises or polls registers one of two callbacks, never both."""
    path = tmp_path / "node.py"
    path.write_text(
        dedent(f"""
        import threading
        import rospy
        from std_msgs.msg import Float64
        class Node:
            def __init__(self):
                self.lock = threading.Lock()
                self.seen = []
                self.pub = rospy.Publisher("/out", Float64, queue_size=1)
                if rospy.get_param("~poll", False):
                    rospy.Timer(rospy.Duration(0.1), self.on_timer)
                {other}:
                    rospy.Subscriber("/in", Float64, self.on_value)
            def on_value(self, msg):
                self.add(msg.data)
            def on_timer(self, event):
                with self.lock:
                    self.add(1.0)
            def add(self, x):
                self.seen.append(x)
                self.pub.publish(sum(self.seen))
        Node()
        rospy.spin()
        """)
    )
    result = run(Options(paths=(tmp_path,), cache=False), Config(select=("TARL201",)))
    assert len(result.findings) == count


ACTIVITY = """
    import threading
    import rospy
    from std_msgs.msg import Float64
    class Node:
        def __init__(self):
            self.lock = threading.Lock()
            self.seen = {{}}
            self.pub = rospy.Publisher("/out", Float64, queue_size=1)
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            if not self.lock.acquire({asked}):
                return
            try:
                self.update(msg)
            finally:
                self.lock.release()
        def update(self, msg):
            self.seen.pop(msg.data, None)
        def on_timer(self, event):
            self.pub.publish(sum(self.seen.values()))
    Node()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("asked", "found"),
    [("blocking=False", 0), ("False", 0), ("blocking=True", 1), ("", 1), ("timeout=1.0", 1)],
)
def test_lock_without_waiters_protects_nothing(asked, found):
    assert len(lines("TARL201", ACTIVITY.format(asked=asked))) == found


def test_lock_counts_if_some_function_waits_for_it():
    waits = "with self.lock:\n                self.pub.publish(sum(self.seen.values()))"
    both = ACTIVITY.format(asked="False").replace("self.pub.publish(sum(self.seen.values()))", waits)
    assert lines("TARL201", both) == []
    reset = 'rospy.Subscriber("/reset", Float64, self.on_reset)\n            rospy.Timer('
    cleared = both.replace("rospy.Timer(", reset).replace("def update(self, msg)", "def on_reset(self, msg)")
    assert len(lines("TARL201", cleared.replace("self.seen.pop(msg.data, None)", "self.seen.clear()"))) == 1


COROUTINE = """
    import asyncio
    import threading
    import rospy
    from std_msgs.msg import Float64
    class Node:
        def __init__(self):
            self.lock = threading.Lock()
            self.loop = asyncio.new_event_loop()
            self.values = []
            self.pub = rospy.Publisher("/out", Float64, queue_size=1)
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            with self.lock:
                {runs}
        async def keep(self, msg):
            self.values.append(msg.data)
        async def pass_on(self, msg):
            await self.keep(msg)
        def on_timer(self, event):
            self.pub.publish(sum(self.values) / len(self.values))
    Node()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("runs", "found"),
    [
        ("asyncio.run_coroutine_threadsafe(self.keep(msg), self.loop)", 0),
        ("asyncio.run_coroutine_threadsafe(self.pass_on(msg), self.loop)", 0),
        ("self.loop.create_task(self.keep(msg))", 0),
        ("asyncio.run(self.keep(msg))", 1),
        ("asyncio.run(self.pass_on(msg))", 1),
        ("self.loop.run_until_complete(self.keep(msg))", 1),
    ],
)
def test_coroutine_that_runs_later_does_not_hold_the_lock(runs, found):
    assert len(lines("TARL201", COROUTINE.format(runs=runs))) == found


MIXIN = """
    class Sender:
        def send(self, value):
            with self.lock:
                self.queue.put(value)
        def flush(self):
            self.queue.put(None)
            self.queue.put(None)
"""

MIXED = """
    import threading
    import rospy
    from queue import Queue
    from std_msgs.msg import Float64
    from a import Sender
    class Node(Sender):
        def __init__(self):
            self.lock = threading.Lock()
            self.queue: {annotation} = None
            self.queue = {made}
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            self.send(msg.data)
        def on_timer(self, event):
            self.flush()
    Node()
    rospy.spin()
"""


@pytest.mark.parametrize(("made", "found"), [("Queue()", 0), ("[]", 1)])
def test_imported_object_may_do_its_own_locking(made, found):
    text = MIXIN if made == "Queue()" else MIXIN.replace(".put(", ".append(")
    assert len(lines("TARL201", text, MIXED.format(annotation="object", made=made))) == found
