"""What the syntax of a program says: quality of service, topics of C++, parameters that decide, stale commands."""

from __future__ import annotations

import ast
from dataclasses import replace
from textwrap import dedent

import pytest

from tarl_lint.evidence import Outline
from tarl_lint.model import Finding, SiteId, Span, Step
from tarl_lint.parameter_names import ARGUMENTS
from tarl_lint.read.source import Module
from tarl_lint.system.command_topics import is_command
from tarl_lint.system.cpp_sources import named_topics
from tarl_lint.system.model import Endpoint, Qos
from tarl_lint.system.parameters import deciding, reads_named_parameters, words
from tarl_lint.system.qos import of_call
from tarl_lint.system.staleness import stale
from tarl_lint.system.table_rows import separated
from tarl_lint.workspace.read import read


def module(text: str, path: str = "node.py") -> Module:
    text = dedent(text)
    return Module(path, "node", text, ast.parse(text))


RELIABLE, EFFORT = Qos(reliable=True, latched=False), Qos(reliable=False, latched=False)
LATCHED = Qos(reliable=True, latched=True)
SUBSCRIBED = "self.create_subscription(F, 'a', f, {})"
PROFILES = [
    (SUBSCRIBED.format("10"), RELIABLE),
    (SUBSCRIBED.format("qos_profile=10"), RELIABLE),
    (SUBSCRIBED.format("qos=10"), RELIABLE),
    ("self.create_subscription(F, 'a', f)", None),
    ("self.create_publisher(F, 'a', 10)", RELIABLE),
    ("self.create_publisher(F, 'a')", None),
    ("self.create_client(F, 'a', 10)", None),
    ("create_publisher(F, 'a', 10)", None),
    (SUBSCRIBED.format("qos_profile_sensor_data"), EFFORT),
    (SUBSCRIBED.format("QoSPresetProfiles.SENSOR_DATA.value"), EFFORT),
    (SUBSCRIBED.format("QoSPresetProfiles.get_from_short_key('sensor_data')"), EFFORT),
    (SUBSCRIBED.format("QoSPresetProfiles.OTHER.value"), None),
    (SUBSCRIBED.format("rclpy.qos.qos_profile_sensor_data"), EFFORT),
    (SUBSCRIBED.format("qos_profile_system_default"), Qos()),
    (SUBSCRIBED.format("qos_profile_default"), RELIABLE),
    (SUBSCRIBED.format("depth"), None),
    (SUBSCRIBED.format("'a'"), None),
    (SUBSCRIBED.format("QoSProfile(depth=1)"), RELIABLE),
    (SUBSCRIBED.format("QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)"), EFFORT),
    (SUBSCRIBED.format("qos.QoSProfile(reliability=P.RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT)"), EFFORT),
    (SUBSCRIBED.format("QoSProfile(durability=DurabilityPolicy.TRANSIENT_LOCAL)"), Qos(reliable=True, latched=True)),
    (SUBSCRIBED.format("QoSProfile(durability=P.RMW_QOS_POLICY_DURABILITY_VOLATILE)"), RELIABLE),
    (SUBSCRIBED.format("QoSProfile(reliability=ReliabilityPolicy.SYSTEM_DEFAULT)"), Qos(reliable=None, latched=False)),
    (SUBSCRIBED.format("QoSProfile(durability=chosen())"), Qos(reliable=True, latched=None)),
    (SUBSCRIBED.format("QoSProfile(**given)"), None),
    (SUBSCRIBED.format("QoSProfile(**{'reliability': R.BEST_EFFORT, 'depth': 1})"), EFFORT),
    (SUBSCRIBED.format("QoSProfile(**dict(reliability=R.BEST_EFFORT), depth=1)"), EFFORT),
    (SUBSCRIBED.format("QoSProfile(**dict(**other))"), None),
    (SUBSCRIBED.format("QoSProfile(**{key: R.BEST_EFFORT})"), None),
    (SUBSCRIBED.format("QoSProfile(**dict(other))"), None),
]  # fmt: skip


def quality(text: str) -> Qos | None:
    """Return the quality of service of the call in the last line."""
    tree = ast.parse(text)
    call = tree.body[-1].value  # type: ignore[attr-defined]
    return of_call(Outline(tree), (call.lineno, call.col_offset, call.end_lineno, call.end_col_offset))


@pytest.mark.parametrize(("call", "found"), PROFILES)
def test_constant_quality_of_service_is_read(call, found):
    assert quality(call) == found


@pytest.mark.parametrize(
    ("before", "found"),
    [
        ("p = QoSProfile(reliability=R.BEST_EFFORT)", EFFORT),
        ("p: QoSProfile = qos_profile_sensor_data", EFFORT),
        ("a = 10\nb = a\np = b", RELIABLE),
        ("a = 10\nb = a\nc = b\np = c", None),
        ("b = 10\np = b", RELIABLE),
        ("p = 10\np = qos_profile_sensor_data", None),
        ("p = QoSProfile(depth=1)\np.reliability = R.BEST_EFFORT", EFFORT),
        ("p = QoSProfile(depth=1)\nself.p.durability = D.TRANSIENT_LOCAL", LATCHED),
        ("p = QoSProfile(depth=1)\np.depth = 5", RELIABLE),
        ("p = QoSProfile(depth=1)\nq.reliability = R.BEST_EFFORT\nprint(p.reliability)", RELIABLE),
        ("p = p", None),
        ("given = {'reliability': R.BEST_EFFORT}\np = QoSProfile(**given)", EFFORT),
        ("given = dict(reliability=R.BEST_EFFORT)\np = QoSProfile(1, **given)", EFFORT),
        ("given = {}\ngiven = {'reliability': R.BEST_EFFORT}\np = QoSProfile(**given)", None),
    ],
)
def test_profile_in_a_variable_includes_assigned_policies(before, found):
    assert quality(f"{before}\n{SUBSCRIBED.format('p')}") == found
    assert quality(f"{before}\n{SUBSCRIBED.format('self.p')}") == found


def test_profile_may_be_imported_under_another_name():
    assert quality("from rclpy.qos import qos_profile_sensor_data as S\n" + SUBSCRIBED.format("S")) == EFFORT
    call = ast.parse(SUBSCRIBED.format("profiles.FAST"))
    place = call.body[0]
    at = (place.lineno, place.col_offset, place.end_lineno or 0, place.end_col_offset or 0)
    profiles = Outline(ast.parse("FAST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)"))
    assert of_call(Outline(call), at, [profiles]) == EFFORT
    assert of_call(Outline(call), at, [profiles, profiles, Outline(ast.parse("FAST = 1"))]) is None
    assert of_call(Outline(call), at) is None


TABLE = """
def sensor(depth=5):
    return QoSProfile(depth=depth, reliability=R.BEST_EFFORT)
class A(Node):
    rows = [(F, 'a', {}), (F, 'b', 10)]
    def __init__(self):
        for kind, topic, profile in self.rows:
            self.create_publisher(kind, topic, profile)
"""


@pytest.mark.parametrize(
    ("profile", "topics", "found"),
    [
        ("sensor()", ["a"], EFFORT), ("sensor(1)", ["b"], RELIABLE), ("10", ["a"], RELIABLE),
        ("10", ["a", "b"], RELIABLE), ("sensor()", ["a", "b"], None), ("other()", ["a"], None), ("10", ["c"], None),
        ("10, 5", ["a"], None),
    ],
)  # fmt: skip
def test_wrapper_profile_is_the_argument_beside_the_topic(profile, topics, found):
    tree = ast.parse(TABLE.format(profile))
    call = next(
        one for one in ast.walk(tree) if isinstance(one, ast.Call) and "create" in ast.unparse(one.func)
    )
    at = (call.lineno, call.col_offset, call.end_lineno or 0, call.end_col_offset or 0)
    assert of_call(Outline(tree), at, (), topics) == found


WRAPPER = """
class Base(Node):
    def sub(self, kind, topic, function, profile=10):
        self.create_subscription(kind, topic, function, profile)
    def pub(self, kind, topic, *, profile=qos_profile_sensor_data):
        self.create_publisher(kind, topic, profile)
{}
"""


def call_in(tree: ast.Module, text: str) -> tuple[int, int, int, int]:
    """Return the position of the first call that contains a text."""
    found = next(one for one in ast.walk(tree) if isinstance(one, ast.Call) and text in ast.unparse(one))
    return found.lineno, found.col_offset, found.end_lineno or 0, found.end_col_offset or 0


@pytest.mark.parametrize(
    ("given", "found"),
    [("", RELIABLE), (", qos_profile_sensor_data", EFFORT), (", profile=qos_profile_sensor_data", EFFORT),
     (", profile=other", None), (", *more", None)],
)  # fmt: skip
def test_wrapper_call_passes_the_profile_or_the_default(given, found):
    tree = ast.parse(WRAPPER.format(f"node.sub(F, name, f{given})"))
    outline = Outline(tree)
    inside = [(outline, call_in(tree, "self.create_subscription"))]
    assert of_call(outline, call_in(tree, "node.sub"), (), (), inside) == found
    assert of_call(outline, call_in(tree, "node.sub")) is None


@pytest.mark.parametrize(
    ("calls", "found"),
    [
        (["node.pub(F, name)", "node.pub(F, other)"], EFFORT),
        (["node.pub(F, name, profile=10)"], RELIABLE),
        (["node.pub(F, name, profile=10)", "node.pub(F, other)"], None),
        ([], None),
    ],
)
def test_wrapper_calls_may_share_a_profile(calls, found):
    tree = ast.parse(WRAPPER.format("\n".join(calls)))
    assert of_call(Outline(tree), call_in(tree, "self.create_publisher")) == found


@pytest.mark.parametrize(
    ("rows", "found"),
    [
        ("{'bell': String, 'door': Bool}", [("bell", "String"), ("door", "Bool")]),
        ("[('bell', String), ('door', msg.Bool)]", [("bell", "String"), ("door", "Bool")]),
        ("{'bell': (String, 10), 'door': (Bool, 1)}", [("bell", "String"), ("door", "Bool")]),
        ("[('bell', String), ('door', Other)]", None),
        ("[('bell', String), ('bell', Bool), ('door', Bool)]", None),
    ],
)
def test_table_rows_state_topic_types(rows, found):
    outline = Outline(ast.parse(f"TOPICS = {rows}"))
    end = Endpoint("subscribes", ("bell", "door"), "Bool | String", Span("a.py", 1, 1, 1, 2))
    parts = separated(end, ["std_msgs/Bool", "std_msgs/String", "demo/Bool"], [outline])
    if found is None:
        assert parts == [end]
    else:
        assert [(one.names[0], one.type) for one in parts] == found
        assert [one.whole_type for one in parts] == ["std_msgs/String", ""]


def test_a_function_of_another_module_may_return_the_profile():
    call = ast.parse(SUBSCRIBED.format("profiles.fast(1)"))
    place = call.body[0]
    at = (place.lineno, place.col_offset, place.end_lineno or 0, place.end_col_offset or 0)
    one = "def fast(depth):\n    return QoSProfile(depth=depth, reliability=R.BEST_EFFORT)"
    assert of_call(Outline(call), at, [Outline(ast.parse(one))]) == EFFORT
    two = one + "\n    return 10"
    assert of_call(Outline(call), at, [Outline(ast.parse(two))]) is None


def test_quality_of_service_is_unknown_without_a_call():
    assert of_call(Outline(ast.parse("f(1)")), (1, 0, 1, 3)) is None


CPP = r"""
// n.advertise<F>("commented", 1);
/* n.subscribe("also", 1); */ auto s = "//"; ros::NodeHandle nh, own("~");
ros::NodeHandle mine = ros::NodeHandle("~");
void f() {
  a = nh.advertise<geometry_msgs::Twist>("cmd_vel", 1);
  b = nh.subscribe("scan", 1, &g);
  c = own.advertise<std_msgs::msg::Float64>( "x", 1); d = mine.subscribe("/y", 1, &g);
  e = nh_priv->subscribe("z", 1, &g); h = pnh.subscribe("~w", 1, &g);
  i = node->create_publisher<std_msgs::msg::Float64>("out", 10);
  j = this->create_subscription<sensor_msgs::msg::LaserScan, Alloc<int>>("in", 10, g);
  k = nh.advertise<F>(name, 1); l = create_publisher<Twist>(
    "late", 1);
}
"""


@pytest.mark.parametrize(
    ("before", "written", "kind"),
    [
        ("", "std_msgs::Bool", "Bool"),
        ("", "std_msgs::msg::Bool", "Bool"),
        ("", "::std_msgs::msg::Bool", "Bool"),
        ("", "arm::Bool", ""),
        ("#include <arm/Bool.h>", "arm::Bool", "Bool"),
        ('#include "arm/Bool.h"', "arm::Bool", "Bool"),
        ("#include <arm/types.hpp>", "arm::Bool", ""),
        ("", "Bool", "Bool"),
        ("using Bool = std_msgs::msg::Float64;", "Bool", ""),
        ("typedef std_msgs::Float64 Bool;", "Bool", ""),
        ("using std_msgs::msg::Bool;", "Bool", "Bool"),
    ],
)
def test_an_alias_in_cpp_is_not_a_message_type(tmp_path, before, written, kind):
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "CMakeLists.txt").write_text("add_executable(drive a.cpp)\n")
    (tmp_path / "a.cpp").write_text(f'{before}\nauto p = n.advertise<{written}>("on", 1);\n')
    package = read(tmp_path).package("arm")
    assert package is not None
    assert [one.type for one in named_topics(package, "drive")] == [kind]


def test_cpp_topics_are_literals_in_calls(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "CMakeLists.txt").write_text(
        "add_executable(raw src/a.cpp src/a.hpp src/none.cpp ../out.cpp)\n"
        "add_executable(b src/b.cc)\nset_target_properties(raw PROPERTIES OUTPUT_NAME drive PREFIX)\n"
        "set_target_properties(b PROPERTIES OUTPUT_NAME)\nadd_executable()\nadd_library(c src/a.cpp)\n"
    )
    (tmp_path / "src").mkdir()
    (tmp_path / "src/a.cpp").write_text(CPP)
    (tmp_path / "src/b.cc").write_text('x.subscribe("b", 1);')
    (tmp_path / "src/a.hpp").write_text('x.subscribe("header", 1);')
    (package,) = read(tmp_path).packages
    found = named_topics(package, "drive")
    assert [(one.role, *one.names, one.type, one.span.line) for one in found] == [
        ("publishes", "cmd_vel", "Twist", 6),
        ("subscribes", "scan", "", 7),
        ("publishes", "~x", "Float64", 8),
        ("subscribes", "/y", "", 8),
        ("subscribes", "~z", "", 9),
        ("subscribes", "~w", "", 9),
        ("publishes", "out", "Float64", 10),
        ("subscribes", "in", "LaserScan", 11),
        ("publishes", "late", "Twist", 12),
    ]
    assert (found[0].span.path, found[0].span.column, found[0].span.end_column) == ("src/a.cpp", 10, 19)
    assert named_topics(package, "raw") == named_topics(package, "c") == ()
    assert [one.names for one in named_topics(package, "b")] == [("b",)]


READS = [
    ("rospy.get_param('~a')", True),
    ("rospy.get_param(name)", False),
    ("rospy.get_param('~')", False),
    ("rospy.get_param('/')", False),
    ("rospy.get_param(f'~{a}')", False),
    ("rospy.get_param()", True),
    ("other(name)", True),
    ("self.declare_parameters('', [])", True),
    ("self.declare_parameters('', [('a', 1), ('b', x)])", True),
    ("self.declare_parameters('', [(a, 1)])", False),
    ("self.declare_parameters(namespace='', parameters=TABLE)\nTABLE = [('a', 1)]", True),
    ("self.declare_parameters('', TABLE)", False),
    ("for name, value in {'a': 1, 'b': -x}.items(): self.declare_parameter(name, value)", True),
    ("T = {'a': 1}\nfor name in sorted(T): self.declare_parameter('x.' + name)", True),
    ("T = {}\nT[x] = 1\nfor name in T: self.declare_parameter(name)", False),
    ("for name in self.get_parameter('names').value: self.get_parameter(f'{name}.x')", False),
    ("self.value = 'a'\nfor name in self.get_parameter('names').value: self.get_parameter(name)", False),
    ("def param(self, name, other): self.declare_parameter(name, other)\nself.param('a', x)", True),
    ("def param(self, name, other): self.declare_parameter(name, other)\nself.param(a, x)", False),
    ("def param(name='a'): get_param(name)\nparam()", True),
    ("def param(name): get_param(name)\nparam(*found)", False),
    ("def param(name): get_param(name)", False),
    ("for f in fields(cls): node.declare_parameter(f.name, f.default)", True),
    ("for one in ['a', 'b']:\n    get_param('~' + one)\nfor one in found: print(one)", False),
    (
        "class C:\n    NAMES = ('a', 'b')\n    def f(self):\n        for n in self.NAMES: self.get_parameter(n)",
        True,
    ),
    ("with open(x) as names: get_param(names)", False),
    ("get_param('a' if x else 'b')", True),
    ("g = lambda name: get_param(name)", False),
    (
        "def own(n): return '~' + n\nclass A: T = {}\nclass B(A): T = {'a': 1}\nfor k in B.T: get_param(own(k))",
        True,
    ),
    ("class A:\n    T = {}\nA.T.update(x)\nA.T = {'a': 1}\nfor k in A.T: get_param(k)", False),
    ("for k in ['a']: get_param(k.upper())", False),
    ("for k in 'ab': get_param(k)", True),
    ("K = 'ab'\nfor k in K: get_param(k)", False),
    ("self.declare_parameters('ns', [])", True),
    ("self.get_parameters(['a', b])", False),
    ("self.get_parameters([b])", False),
    ("self.get_parameters([])", True),
    ("Node('n', allow_undeclared_parameters=True)", False),
    ("Node('n', allow_undeclared_parameters=False)", True),
    ("from dynamic_reconfigure.client import Client", False),
    ("from dynamic_reconfigure.server import Server", True),
    ("self.get_parameters_by_prefix('a')", False),
]


@pytest.mark.parametrize(("text", "named"), READS)
def test_a_program_reads_only_parameters_that_it_names(text, named):
    assert reads_named_parameters([module("x = 1"), module(text)]) is named


def test_parts_of_format_strings_are_words():
    assert words([module("'%s_max' % a; '{}.kp'.format(a)")]) == {"%s_max", "_max", "{}.kp", "kp", ""}
    assert words([module("for a in 'xy': f(a)\n[b for b in 'z']")]) == {"xy", "x", "y", "z"}


def test_any_string_of_a_program_may_be_a_used_name():
    assert words([module("a = '~b/'\nc = f'x{1}.y'"), module("'/d/e'; 1; b'f'")]) == {"b", "x", "y", "d/e"}
    assert words([module("class C:\n    a: int = 1\n    b = 2\nc: int = 1\ndict(d=1, **e)\nf(g=1)")]) == {
        "a",
        "d",
    }


DECIDING = [
    ("if rospy.get_param('~a'): pass", ("~a",)),
    ("x = rospy.get_param('~a')", ()),
    ("x = rospy.get_param('~a')\nif x: pass", ("~a",)),
    ("x = rospy.get_param('~a')\nwhile not x: pass", ("~a",)),
    ("y = 1 if self.x else 2\nself.x: bool = self.get_parameter('a').value", ("a",)),
    ("x = rospy.get_param('~a')\ny = x\nif y: pass", ("~a",)),
    ("x = rospy.get_param('~a')\ny = not bool(x)\nif y: pass", ("~a",)),
    ("x = rospy.get_param('~a')\ny = x + 1\nif y: pass", ()),
    ("x = rospy.get_param('~a')\ny = max(x)\nif y: pass", ()),
    ("x = rospy.get_param('~a')\ny = int(x, 16)\nif y: pass", ()),
    ("for x in rospy.get_param('~a'): pass", ("~a",)),
    ("[x for x in rospy.get_param('~a')]", ("~a",)),
    ("t[rospy.get_param('~a')]", ("~a",)),
    ("def f(on):\n    if on: pass\nf(rospy.get_param('~a'))", ("~a",)),
    ("def f(on):\n    if on: pass\nf(on=rospy.get_param('~a'))", ("~a",)),
    ("def f(off, on):\n    if on: pass\nf(rospy.get_param('~a'), 1)", ()),
    ("class C:\n    def __init__(self, on):\n        if on: pass\nC(rospy.get_param('~a'))", ("~a",)),
    ("class C:\n    def other(self, on):\n        if on: pass\nC(rospy.get_param('~a'))", ()),
    ("if rospy.get_param(name): pass", ()),
    ("if get_param('b') and has_param('a'): pass", ("a", "b")),
    ("if other('a'): pass", ()),
    ("import sys\nx = sys.argv", (ARGUMENTS,)),
    ("import argparse\nif get_param('b'): pass", (ARGUMENTS, "b")),
]


@pytest.mark.parametrize(("text", "names"), DECIDING)
def test_parameters_used_in_conditions_are_listed(text, names):
    assert deciding([module(text)]) == tuple(sorted(names))


CONTROL = """
    class C:
        def __init__(self):
            self.cmd = None
        def on(self, msg):
            self.cmd = msg.linear
        def tick(self):
            self.pub.publish(self.cmd)
"""


def command(example, **given) -> Finding:
    """Return a flow from C.on to a command that C.tick publishes."""

    def step(qualname: str, code: str, role: str) -> Step:
        return Step(SiteId("node", qualname, code), example.span("pos = data"), code, role, "data")  # type: ignore[arg-type]

    steps = (
        step("C.on", "self.cmd = msg.linear", "assign"),
        step("C.tick", "self.pub.publish(self.cmd)", "publish"),
    )
    flow = example.flow()
    source = replace(
        flow.source, callback=given.pop("callback", "C.on"), api=given.pop("api", flow.source.api)
    )
    sink = replace(flow.sink, qualname=given.pop("qualname", "C.tick"), type=given.pop("type", "Twist"))
    kind = given.pop("kind", "explicit")
    return replace(
        example.finding(),
        flow=replace(flow, kind=kind, source=source, sink=sink, steps=given.pop("steps", steps)),
    )


def test_a_command_that_a_timer_repeats_is_stale(example):
    found = command(example)
    assert stale([found], [module(CONTROL)]) == (found,)


def test_numbers_on_movement_topics_are_movement_commands():
    names = {"wheel_velocity/command": True, "cmd_vel": True, "arm/command": True, "speed": False, "leftThrust": True,
             "thrust/state": False, "command/log/level": False}  # fmt: skip
    assert {one: is_command("Float64", (one,)) for one in names} == names
    assert not is_command("String", ("cmd_vel",))


@pytest.mark.parametrize(
    "given",
    [{"kind": "implicit"}, {"type": "Float64"}, {"api": "rospy.Service"}, {"qualname": "C.on"}, {"callback": ""},
     {"callback": "C.other"}, {"qualname": "C.other"}, {"steps": ()}],
)  # fmt: skip
def test_other_flows_are_not_stale(example, given):
    assert stale([command(example, **given)], [module(CONTROL)]) == ()


@pytest.mark.parametrize(
    ("more", "found"),
    [
        ("    def stop(self):\n            self.cmd = None\n", False),
        ("    def stop(self):\n            self.other = None\n", True),
        ("    def stop(self):\n            self.tick()\n", False),
        ("    def stop(self):\n            while ok():\n                self.tick()\n", True),
        ("    def stop(self):\n            self.stamp = rospy.Time.now()\n", True),
        (
            "    def check(self):\n            self.stamp = rospy.Time.now()\n        t = Timer(1, check)\n",
            False,
        ),
        (
            "    def check(self):\n            cmd.header.stamp = rospy.Time.now()\n        t = Timer(1, check)\n",
            True,
        ),
        ("    def check(self):\n            self.cmd = 0\n        t = Timer(1, check)\n", False),
        ("    def check(self):\n            self.cmd *= 0.5\n        t = Timer(1, check)\n", False),
        ("    def check(self):\n            self.last_seen = 1\n        t = Timer(1, check)\n", False),
        ("    def stop(self):\n            self.elapsed = 1\n", True),
        ("    def stop(self):\n            self.watchdog = 1\n", False),
        ("    def stop(self):\n            time.sleep(1.0)\n", True),
        ("    def stop(self):\n            rospy.Timer(rospy.Duration(1.0), self.tick)\n", True),
        ("    s = Service('a', Trigger, tick)\n", False),
    ],
)
def test_cleared_or_timed_command_is_not_stale(example, more, found):
    assert bool(stale([command(example)], [module(CONTROL + "    " + more)])) is found
    assert stale([], [module(CONTROL)]) == ()
