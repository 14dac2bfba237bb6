"""A callback that returns a value of a wrong type is named in the error, although the executor notices it."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import blame, message_type
from tests.plugin.ros.conftest import Start

FIBONACCI = """
import rclpy
from rclpy.action import ActionClient, ActionServer
from example_interfaces.action import Fibonacci
rclpy.init()
node = rclpy.create_node("server")

def work(goal):
    goal.succeed()
    return RETURNED

ActionServer(node, Fibonacci, "fib", work)
client = ActionClient(node, Fibonacci, "fib")
sent = client.send_goal_async(Fibonacci.Goal(order=2))
sent.add_done_callback(lambda future: future.result().get_result_async())
rclpy.spin(node)
"""
SERVICE = """
import rclpy
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node("server")

def work(request, response):
    return RETURNED

node.create_service(Trigger, "dock", work)
rclpy.spin(node)
"""


@pytest.mark.parametrize("returned", ["{'sequence': [1]}", "None", "Fibonacci.Goal()"])
@pytest.mark.parametrize("kind", ["def work", "async def work"])
def test_the_execute_callback_of_an_action_is_named(start: Start, kind: str, returned: str) -> None:
    source = FIBONACCI.replace("RETURNED", returned).replace("def work", kind)
    line = source.splitlines().index(f"{kind}(goal):") + 1
    with pytest.raises(NodeError) as failed:
        start(source).step(1)
    said = str(failed.value)
    assert "the execute callback of action /fib returned <class " in said
    assert re.search(rf"\(\S*node\.py, line {line}, in work\)", said)


@pytest.mark.parametrize("kind", ["def work", "async def work"])
def test_the_callback_of_a_service_is_named(start: Start, kind: str) -> None:
    source = SERVICE.replace("RETURNED", "{}").replace("def work", kind)
    line = source.splitlines().index(f"{kind}(request, response):") + 1
    ros = start(source)
    with pytest.raises(NodeError, match=rf"callback of service /dock .*'dict'.*line {line}, in work"):
        ros.bus.call("dock", message_type("std_srvs/srv/Trigger").Request())


class Called:
    def __call__(self) -> None:
        """Do nothing."""

    def method(self) -> None:
        """Do nothing."""


@pytest.mark.parametrize(
    ("function", "name"),
    [
        (Called().method, "method"),
        (Called.method, "method"),
        (partial(partial(Called().method)), "method"),
        (Called(), "__call__"),
        (lambda: None, "<lambda>"),
    ],
)
def test_the_reported_place_of_a_callable_is_its_definition(function: Any, name: str) -> None:
    place = blame.of_function(function)
    assert place is not None
    assert (place[0], place[2]) == (__file__, name)


def test_a_builtin_has_no_place() -> None:
    assert blame.of_function(len) is None
