"""A call that ends the program decides what follows, as `raise` and `return` do."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tests.lint.models.marked import differing

NODE = """\
import os
import sys
import rospy
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)

def stop():
    sys.exit(1)

def main():
    rospy.init_node("node")
    try:
        msg = rospy.wait_for_message("in", Float64)
    finally:
        pass
    BODY
    out.publish(1.0)  # MARK

main()
"""


@pytest.mark.parametrize(
    "leaving", ["sys.exit(1)", "sys.exit()", "exit()", "quit(3)", "os._exit(1)", "os.abort()", "stop()"]
)
def test_code_after_an_exit_call_depends_on_its_condition(leaving: str) -> None:
    assert not differing(_node(f"if msg.data > 1.0:\n        {leaving}", "control"))


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ("if msg.data > 1.0:\n        sys.getrefcount(1)", "clean"),
        ("if rospy.get_param('limit') > 1.0:\n        sys.exit(1)", "clean"),
        ("try:\n        if msg.data > 1.0: sys.exit(1)\n    except Exception:\n        pass", "control"),
        ("try:\n        if msg.data > 1.0: sys.exit(1)\n    except SystemExit:\n        pass", "clean"),
        ("try:\n        if msg.data > 1.0: sys.exit(1)\n    except:\n        pass", "clean"),
    ],
)
def test_exit_call_counts_only_if_no_handler_catches_it(body: str, kind: str) -> None:
    assert not differing(_node(body, kind))


@pytest.mark.parametrize(
    "own", ["def exit(): pass", "from shop import exit", "exit = print", "import shop as exit"]
)
def test_another_function_named_exit_does_not_end_the_program(own: str) -> None:
    body = "if msg.data > 1.0:\n        exit()"
    assert not differing(f"{own}\n{_node(body, 'clean')}")


def test_exit_imported_from_sys_ends_the_program() -> None:
    body = "if msg.data > 1.0:\n        exit()"
    assert not differing(f"from sys import exit\n{_node(body, 'control')}")


def _node(body: str, mark: str) -> str:
    return dedent(NODE).replace("BODY", body).replace("MARK", mark)
