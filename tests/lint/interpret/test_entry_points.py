"""Which functions and methods run although nothing in the files calls them."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing

HEAD = """\
import rclpy, rospy, smach, threading
from rclpy.node import Node
from std_msgs.msg import Float64
import framework

last = 0.0
out = rospy.Publisher("out", Float64, queue_size=1)

def on(msg):
    global last
    last = msg.data

rospy.Subscriber("in", Float64, on)
"""


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            """
            class Work(threading.Thread):
                def run(self):
                    out.publish(last)  # data
                def other(self):
                    out.publish(last)  # clean
            Work().start()
            """,
            id="run of a thread",
        ),
        pytest.param(
            """
            class Plain:
                def run(self):
                    out.publish(last)  # clean
                def on_timer(self):
                    out.publish(last)  # clean
            Plain()
            """,
            id="no method of a plain class",
        ),
        pytest.param(
            """
            class Plugin(framework.Plugin):
                def step(self):
                    out.publish(last)  # data
                def _inner(self):
                    out.publish(last)  # clean
            Plugin()
            """,
            id="public methods of a framework's class",
        ),
        pytest.param(
            """
            class Nearby(Node):
                def __init__(self):
                    super().__init__("nearby")
                    self.create_subscription(Float64, "in", self.heard, 10)
                def heard(self, msg):
                    out.publish(msg.data)  # data
                def on_activate(self, state):
                    out.publish(last)  # data
                def command(self):
                    out.publish(last)  # data
                def _unused(self):
                    out.publish(last)  # clean
            """,
            id="a node that nothing makes",
        ),
        pytest.param(
            """
            class Near(smach.State):
                def execute(self, userdata):
                    userdata.seen = last
                def on_outcome(self, value):
                    out.publish(value.seen)  # clean
            class Far(smach.State):
                def execute(self, userdata):
                    out.publish(userdata.seen)  # data
            Near(), Far()
            """,
            id="only execute gets the userdata of a state",
        ),
        pytest.param(
            """
            class Near(smach.State):
                def execute(self, userdata):
                    userdata.seen = last
            class Far(framework.State):
                def execute(self, value):
                    out.publish(value.seen)  # clean
            Near(), Far()
            """,
            id="no other class gets userdata",
        ),
        pytest.param(
            """
            def main():
                rospy.init_node("node")
                out.publish(last)  # data
            def other():
                out.publish(last)  # clean
            """,
            id="a main function that starts a node",
        ),
    ],
)
def test_functions_that_are_not_entry_points_do_not_run(text):
    assert differing(HEAD + dedent(text)) == {}


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            """
            if rospy.get_param("wanted"):
                class Guarded(Node):
                    def __init__(self):
                        super().__init__("guarded")
                        self.create_subscription(Float64, "own", self.on_own, 1)
                    def on_own(self, msg):
                        out.publish(msg)  # data
            """,
            id="a node class in an if",
        ),
        pytest.param(
            """
            try:
                import wheel
            except ImportError:
                class Wheel(Node):
                    def __init__(self):
                        super().__init__("wheel")
                        self.create_subscription(Float64, "own", self.on_own, 1)
                    def on_own(self, msg):
                        out.publish(msg)  # data
            else:
                def main():
                    rospy.init_node("node")
                    out.publish(last)  # data
            """,
            id="a node class in a handler, and main beside it",
        ),
        pytest.param(
            """
            class Plugin(framework.Plugin):
                if rospy.get_param("fast"):
                    def step(self):
                        out.publish(last)  # data
            Plugin()
            """,
            id="a method of a framework in an if",
        ),
    ],
)
def test_definitions_inside_other_statements_are_entry_points(text):
    assert differing(HEAD + dedent(text)) == {}


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            """
            @framework.tool
            def drive(value):
                out.publish(last)  # data
            """,
            id="a decorator of another package",
        ),
        pytest.param(
            """
            from framework import tool
            @tool("name", retries=3)
            def drive(value):
                out.publish(last)  # data
            """,
            id="a call of an imported decorator",
        ),
        pytest.param(
            """
            class Skills(framework.Skills):
                @framework.skill
                def _drive(self):
                    out.publish(last)  # data
                def _inner(self):
                    out.publish(last)  # clean
            Skills()
            """,
            id="a private method",
        ),
        pytest.param(
            """
            import functools, numba
            @functools.lru_cache
            def kept(value):
                out.publish(last)  # clean
            @numba.jit
            def fast(value):
                out.publish(last)  # clean
            """,
            id="decorators that register nothing",
        ),
        pytest.param(
            """
            @framework.tool
            def send(value):
                out.publish(value)  # clean
            send(1.0)
            """,
            id="a decorated function that the file calls",
        ),
    ],
)
def test_function_with_a_foreign_decorator_may_be_called(text):
    assert differing(HEAD + dedent(text)) == {}


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            """
            @framework.tool
            def level(scale):
                return rospy.wait_for_message("level", Float64)
            out.publish(level.invoke({"scale": 2}))  # data
            """,
            id="a method of the decorated function calls it",
        ),
        pytest.param(
            """
            import functools
            @functools.lru_cache
            def level(scale):
                return rospy.wait_for_message("level", Float64)
            out.publish(level.cache_info())  # clean
            """,
            id="no method of a cached function",
        ),
    ],
)
def test_a_method_of_a_decorated_function_may_call_it(text):
    assert differing(HEAD + dedent(text)) == {}


@pytest.mark.parametrize(
    ("look", "mark"),
    [
        ("self.query_one(View).level", "data"),
        ("self.find_child(View, name='a').level", "data"),
        ("self.query_one(Base).level", "data"),
        ("self.query_one(Other).level", "clean"),
        ("self.describe(View).level", "clean"),
    ],
)
def test_library_may_return_an_instance_of_a_looked_up_class(look, mark):
    text = f"""
        class Base(framework.Widget):
            pass
        class View(Base):
            def __init__(self):
                super().__init__()
                self.level = 0.0
            def on_level(self, msg):
                self.level = msg.data
        class Other(framework.Widget):
            level = 1.0
        class App(framework.App):
            def compose(self):
                rospy.Subscriber("level", Float64, View().on_level)
                Other()
            def action_send(self):
                out.publish({look})  # {mark}
        App()
    """
    assert differing(HEAD + dedent(text)) == {}


MADE_IN_MAIN = {
    "shop/stage.py": """\
class Stage:
    def __init__(self):
        self.closed = 0.0
        self.noise = 0.0
""",
    "shop/director.py": """\
from rclpy.node import Node
from std_msgs.msg import Float64

class Director(Node):
    def __init__(self, stage):
        super().__init__("director")
        self.stage = stage
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, "noise", self.on_noise, 1)
        self.create_subscription(Float64, "close", self.on_close, 1)

    def on_noise(self, msg):
        self.stage.noise = msg.data
        self.out.publish(Float64(data=self.stage.noise))

    def on_close(self, msg):
        self.stage.closed = msg.data
""",
    "shop/show.py": """\
import rclpy
from shop.director import Director
from shop.stage import Stage

def main():
    rclpy.init()
    rclpy.spin(Director(Stage()))
""",
}


def test_a_class_that_a_main_function_instantiates_is_not_instantiated_with_unknown_arguments() -> None:
    modules = [
        parse(path, text.encode(), path.removesuffix(".py").replace("/", "."))
        for path, text in MADE_IN_MAIN.items()
    ]
    found = engine.analyse([one for one in modules if isinstance(one, Module)], Config())
    assert [(flow.source.topics, flow.kind) for flow in found] == [(("noise",), "explicit")]
