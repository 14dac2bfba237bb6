import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

import tarl_lint
from tarl_lint.engine import HAZARDS, findings, hazards
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.prefilter.one_sided_groups import one_sided
from tarl_lint.read.source import Module, parse
from tarl_lint.rules import tarl101, tarl102
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config

CASES = Path(__file__).parents[1] / "cases"
EXAMPLES = {
    f"{rule.CODE}-{kind}-{number}": text
    for rule in (tarl101, tarl102, *HAZARDS)
    for kind, texts in (("invalid", rule.INVALID), ("valid", rule.VALID))
    for number, text in enumerate(texts)
}
SHIPPED = tuple(rule for rule in HAZARDS if rule.CODE <= "TARL204")  # another rule may require a run
TALKER = """
    import rospy
    class Talker:
        def __init__(self):
            self.pub = rospy.Publisher("chatter", String, queue_size=1)
        def say(self, event):
            self.pub.publish("hello")
    talker = Talker()
    rospy.Timer(rospy.Duration(1), talker.say)
    """
LISTENER = """
    import rospy
    def on(msg):  # nothing is published here
        rospy.loginfo(msg.data)
    rospy.Subscriber("chatter", String, on)
    """


def module(text, name="node"):
    parsed = parse(f"{name}.py", dedent(text).encode(), name)
    assert isinstance(parsed, Module)
    return parsed


def skipped(*texts, rules=SHIPPED, **settings):
    return one_sided([module(text, f"node{n}") for n, text in enumerate(texts)], Config(**settings), rules)


def found(modules):
    machine = Linker(modules, Config(), thorough=False)
    with_deep_stack(machine.link)
    tracer = Tracer(machine)
    flows = tracer.flows()
    return (*findings(flows), *hazards(tracer, flows, Config()))


def test_one_sided_modules_are_not_analysed():
    assert skipped(TALKER)
    assert skipped(LISTENER)
    assert not skipped(TALKER, LISTENER)


@pytest.mark.parametrize("text", EXAMPLES.values(), ids=EXAMPLES)
def test_modules_that_the_prefilter_skips_have_no_findings(text):
    assert not (skipped(text, rules=HAZARDS) and found([module(text)]))


def test_cases_that_the_prefilter_skips_have_no_findings():
    for path in sorted(CASES.rglob("*.py")):
        if skipped(text := path.read_text(), rules=HAZARDS):
            assert not found([module(text)]), path


@pytest.mark.parametrize(
    "changed",
    [
        ("self.pub.publish", "self.out.publish"),  # never published on
        ("self.pub = rospy.Publisher", "self.pub, self.x = 1, rospy.Publisher"),
        ("import rospy", "import rospy\n    from rospy import Publisher as P\n    other = P('x', String)"),
        ("self.pub.publish", "self.pub = rospy.Publisher('other', String); self.pub.publish"),
        ('self.pub.publish("hello")', 'self.pub.publish(rospy.wait_for_message("a", String))'),
        ("import rospy", "import rospy\n    rospy.Service('s', Empty, lambda request: 1)"),
    ],
)
def test_publishing_module_is_analysed_if_it_may_subscribe(changed):
    assert not skipped(TALKER.replace(*changed))


def test_subscribing_module_is_analysed_if_a_callback_may_be_empty():
    assert not skipped(LISTENER.replace("rospy.loginfo(msg.data)", "last = msg.data"))
    assert skipped(LISTENER.replace("rospy.loginfo(msg.data)", "pass").replace("on(msg)", "on(_)"))


LOCKED = """
    import threading
    import rospy
    class Listener:
        def __init__(self):
            self.lock = threading.Lock()
            self.last = None
            rospy.Subscriber("chatter", String, self.on)
        def on(self, msg):
            with self.lock:
                self.last = str(msg.data)
            rospy.loginfo(msg.data)
        def show(self):
            with self.lock:
                rospy.loginfo(self.last)
    listener = Listener()
    while not rospy.is_shutdown():
        listener.show()
    """


def test_module_with_consistent_locking_is_not_analysed():
    assert skipped(LOCKED)
    assert skipped(LOCKED.replace("with self.lock", "if True"))


def test_lock_method_is_not_a_function_of_the_same_name():
    """`Condition.wait` does not call the module's `wait`, unless the attribute may hold something else."""
    waiting = LOCKED.replace("threading.Lock()", "threading.Condition()").replace(
        "rospy.loginfo(self.last)",
        "self.lock.wait()\n                rospy.loginfo(self.last)\n        def wait(self):\n            pass",
    )
    assert skipped(waiting)
    assert not skipped(waiting.replace("self.lock.wait()", "self.wait()"))
    assert not skipped(waiting.replace("self.last = None", "self.lock = self"))


@pytest.mark.parametrize(
    "changed",
    [
        (
            "                rospy.loginfo(self.last)",
            "                pass\n            rospy.loginfo(self.last)",
        ),
        (
            "rospy.loginfo(self.last)",
            "self.tell()\n        def tell(self):\n            rospy.loginfo(self.last)",
        ),
    ],
)
def test_module_with_unlocked_state_is_analysed(changed):
    text = LOCKED.replace(*changed)
    assert text != LOCKED
    assert not skipped(text)


@pytest.mark.parametrize(
    ("text", "run"),
    [
        ("def on(msg):\n    last = msg.data\nrospy.Subscriber('a', String, on)", True),
        ("def on(msg):\n    last = msg.data\nrospy.Subscriber('a', String, getattr(me, 'on'))", True),
        ("def on(msg):\n    last = msg.data\non(rospy.wait_for_message('a', String))", False),
    ],
)
def test_empty_function_is_a_callback_only_as_an_argument(text, run):
    assert skipped("import rospy\n" + text) is not run


def test_disabled_hazard_rule_needs_no_analysis():
    idle = LISTENER.replace("rospy.loginfo(msg.data)", "last = msg.data")
    assert skipped(idle, ignore=("TARL203",))


def test_functions_in_the_settings_may_publish_or_subscribe():
    assert not skipped(TALKER, sources=("bus.listen",))


NEW_RULE = '''
"""TARL299: a callback logs nothing."""
from collections.abc import Iterator
from tarl_lint.evidence import Evidence
from tarl_lint.model import Finding
from tarl_lint.prefilter.one_sided_groups import Side

CODE = "TARL299"
SUMMARY = "a source is subscribed to"
INVALID = VALID = ("",)


def findings(evidence: Evidence) -> Iterator[Finding]:
    for record in evidence.machine.sources.values():
        source = evidence.tracer.ends.source(record)
        yield evidence.finding(CODE, source.span, "heard", "heard")
'''


@pytest.mark.parametrize("rules_out", [True, False, None])
@pytest.mark.parametrize("text", [LISTENER, TALKER])
def test_file_of_a_new_rule_names_irrelevant_nodes(tmp_path, rules_out, text):
    """A rule without `ruled_out` runs on every node, also on nodes that only subscribe or only publish."""
    package = tmp_path / "tarl_lint"
    shutil.copytree(Path(tarl_lint.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    said = "" if rules_out is None else f"\n\ndef ruled_out(side: Side) -> bool:\n    return {rules_out}\n"
    (package / "rules" / "tarl299.py").write_text(NEW_RULE.lstrip() + said)
    (tmp_path / "node.py").write_text(dedent(text))
    script = (
        "import sys; sys.path.insert(0, sys.argv.pop()); from tarl_lint.cli import main; sys.exit(main())"
    )
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            script,
            "--no-cache",
            "--select=TARL299",
            "--format=concise",
            "node.py",
            tmp_path,
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.stderr
    assert ("TARL299 heard" in done.stdout) == (text == LISTENER and not rules_out)
