"""The name of a node as its program gives it."""

import ast
from textwrap import dedent

import pytest

from tarl_lint.node_names import node_name

NAMED = {
    "rospy": 'rospy.init_node("talker")',
    "keyword": 'rospy.init_node(name="talker")',
    "constant": 'NAME = "talker"\nrospy.init_node(NAME)',
    "created": 'node = rclpy.create_node("talker")',
    "class of rclpy": 'from rclpy.node import Node\nnode = Node("talker")',
    "class of rclpy by another name": 'from rclpy.node import Node as RosNode\nnode = RosNode(node_name="talker")',
    "class of rclpy in full": 'node = rclpy.node.Node("talker")',
    "super": """
        class Talker(Node):
            def __init__(self):
                super().__init__("talker")
        """,
    "base class": """
        class Talker(Node):
            def __init__(self):
                Node.__init__(self, "talker")
        """,
    "default": """
        class Talker(LifecycleNode):
            def __init__(self, rate=1, name="talker"):
                super().__init__(name)
        """,
    "argument": """
        class Talker(Node):
            def __init__(self, name="other"):
                super().__init__(name)
        Talker("talker")
        """,
    "keyword argument": """
        class Talker(Node):
            def __init__(self, rate, name):
                super().__init__(node_name=name)
        Talker(1.0, name="talker")
        """,
}
UNNAMED = {
    "computed": "rospy.init_node(sys.argv[1])",
    "not a node": 'from graph import Node\nNode("talker")',
    "a part of a node": """
        class Part(Node):
            def __init__(self):
                Other.__init__(self, "talker")
        """,
    "two names": """
        class Talker(Node):
            def __init__(self, name):
                super().__init__(name)
        Talker("a"), Talker("b")
        """,
    "assigned twice": 'NAME = "a"\nNAME = "b"\nrospy.init_node(NAME)',
}


@pytest.mark.parametrize("style", NAMED)
def test_node_name_in_the_code_is_found(style: str) -> None:
    assert node_name(ast.parse(dedent(NAMED[style]))) == "talker"


@pytest.mark.parametrize("style", UNNAMED)
def test_a_name_that_is_not_constant_is_unknown(style: str) -> None:
    assert node_name(ast.parse(dedent(UNNAMED[style]))) == ""
