"""A program that exhausts its budget is named in every format, by file and node."""

from __future__ import annotations

import ast
import json
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from tarl_lint import engine
from tarl_lint.interpret import fixpoint
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory import value_flow_graph
from tarl_lint.model import Cut
from tarl_lint.node_names import node_name
from tarl_lint.read.source import Module
from tarl_lint.report import FORMATS
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.run.runner import Result
from tarl_lint.settings.config import Config
from tests.lint.reports import everything, text_of

CUT = Cut("src/pilot.py", "pilot")


@pytest.fixture
def result(example) -> Result:
    whole = everything(example)
    return replace(whole, statistics=replace(whole.statistics, cut=(CUT,)))


@pytest.mark.parametrize("name", [n for n in FORMATS if n not in ("dot", "mermaid", "topics")])
def test_an_incomplete_program_is_named_in_every_format(name, result):
    text = text_of(name, result)
    assert "src/pilot.py" in text
    assert "pilot" in text.replace("src/pilot.py", "")


def test_incomplete_programs_are_marked_in_json(result, example):
    entry = {"path": "src/pilot.py", "node": "pilot", "message": CUT.message}
    assert json.loads(text_of("json", result))["incomplete"] == [entry]
    assert "incomplete" not in json.loads(text_of("json", everything(example)))


def test_sarif_has_a_notification_at_the_file(result):
    (run,) = json.loads(text_of("sarif", result))["runs"]
    notes = run["invocations"][0]["toolExecutionNotifications"]
    (note,) = [n for n in notes if n["descriptor"]["id"] == "budget-spent"]
    assert note["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "src/pilot.py"


def test_junit_has_a_skipped_case(result):
    tree = ElementTree.fromstring(text_of("junit", result))
    (case,) = [c for c in tree.iter("testcase") if c.get("classname") == "src/pilot.py"]
    assert "may be missing" in str(case.find("skipped").get("message"))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("rospy.init_node('pilot')", "pilot"),
        ("rospy.init_node(name='pilot', anonymous=True)", "pilot"),
        ("def main():\n    node = rclpy.create_node('pilot')", "pilot"),
        ("class A(Node):\n    def __init__(self):\n        super().__init__('pilot')", "pilot"),
        ("class A(Thread):\n    def __init__(self):\n        super().__init__('worker')", ""),
        ("rospy.init_node(sys.argv[1])", ""),
        ("x = 1", ""),
    ],
)
def test_node_name_is_found_without_an_analysis(text, name):
    assert node_name(ast.parse(text)) == name


LIBRARY = "def helper(x):\n    return x\n"
SMALL = (
    "import rospy\nfrom lib import helper\npub = rospy.Publisher('b', F)\n"
    "def on(msg):\n    pub.publish(helper(msg.data))\nrospy.Subscriber('a', F, on)\n"
)


FEW = 2_000  # statements per run in these tests


def large() -> str:
    """Return a node whose run exceeds the limit on statements."""
    body = "".join(f"    x = helper(x) + {n}\n" for n in range(FEW))
    return SMALL.replace(
        "    pub.publish(helper(msg.data))\n", f"    x = msg.data\n{body}    pub.publish(x)\n"
    )


def test_programs_with_common_imports_have_separate_budgets(monkeypatch):
    monkeypatch.setattr(fixpoint, "MAX_STATEMENTS", FEW)
    texts = {"lib.py": LIBRARY, "large.py": large(), "small.py": SMALL}
    modules = [Module(p, p.removesuffix(".py"), t, ast.parse(t)) for p, t in texts.items()]
    machine = Linker(modules, Config(), thorough=False)
    with_deep_stack(machine.link)
    assert list(machine.cut) == ["large.py"]
    assert machine.work.totals["small.py"] < 50


BRIDGED = (
    "import rospy\nfrom cv_bridge import CvBridge\nfrom lib import helper\npub = rospy.Publisher('b', Image)\n"
    "def on(msg):\n    bridge = CvBridge()\n    image = bridge.imgmsg_to_cv2(msg)\n    image[helper(image) > 3] = 0\n"
    "    image = helper(image) * 2\n    out = bridge.cv2_to_imgmsg(image)\n    pub.publish(out)\n"
    "rospy.Subscriber('a', Image, on)\n"
)


def test_node_steps_ignore_other_importers(monkeypatch):
    def steps(texts):
        modules = [Module(p, p.removesuffix(".py"), t, ast.parse(t)) for p, t in texts.items()]
        flows = [f for f in engine.analyse(modules, Config()) if f.sink.span.path == "node.py"]
        return [(s.span.line, s.dependence) for s in flows[0].steps]

    alone = {"lib.py": LIBRARY, "node.py": BRIDGED}
    expected = steps(alone)
    assert (7, "data") in expected
    monkeypatch.setattr(value_flow_graph, "MAX_NODES", 60)  # enough for one node, but not for nine
    others = {f"another{n}.py": BRIDGED for n in range(8)}
    assert steps(alone) == expected
    assert steps({**others, **alone}) == expected
