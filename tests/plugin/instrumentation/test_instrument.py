from __future__ import annotations

import ast
import inspect
import linecache
import sys
import textwrap
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.instrument import Offset, instrument
from pytest_tarl.instrumentation.instrument import compiled as code_of
from tests.plugin.instrumentation.programs import (
    FILE,
    MODES,
    assert_same,
    compiled,
    everywhere,
    recorded,
    run,
)
from tests.slow import SLOW

# Recorded events by statement: (source, events as (line, value))

RECORDED = {
    "assignment": ("x = 1.5", [(1, 1.5)]),
    "tuple": ("a, b = 1.0, 2.0", [(1, (1.0, 2.0))]),
    "starred": ("a, *b = 1, 2, 3", [(1, (1, 2, 3))]),
    "chain": ("a = b = 2.0", [(1, 2.0)]),
    "annotated": ("x: float = 2.0\ny: int", [(1, 2.0)]),
    "attribute": ("class A: pass\nA.x = 3.0", [(1, 0.0), (2, 3.0)]),
    "subscript": ("d = {}\nd['k'] = 3.0", [(1, {"k": 3.0}), (2, 3.0)]),
    "augmented name": ("x = 1.0\nx += 2", [(1, 1.0), (2, 3.0)]),
    "augmented item": ("d = [1.0]\nd[0] += 2.0", [(1, [3.0]), (2, 2.0)]),
    "walrus": ("if (x := 4.0) > 3: pass", [(1, 1.0), (1, 0.0)]),
    "condition": ("if 2 > 1 and 0:\n  pass\nelif 1 < 2 < 3:\n  pass", [(1, 0.0), (3, 1.0), (4, 0.0)]),
    "loop condition": ("i = 2\nwhile i: i -= 2", [(1, 2), (2, 1.0), (2, 0), (2, 0.0)]),
    "endless loop": ("while True:\n  break", [(2, 0.0)]),
    "for": ("for x in (1.0, 2.0): pass", [(1, 1.0), (1, 0.0), (1, 2.0), (1, 0.0)]),
    "for with a pair": ("for a, b in [(1, 2)]: pass", [(1, [(1, 2)]), (1, 0.0)]),
    "assert": ("x = 3\nassert x and True\nassert not x", [(1, 3), (2, 1.0)]),
    "with": ("import contextlib\nwith contextlib.nullcontext(5.0) as x: pass", [(2, 5.0), (2, 0.0)]),
    "match": ("match 7.0:\n  case x if x > 2: pass", [(1, 7.0), (2, True), (2, 0.0)]),
    "del": ("x = 1.0\ndel x", [(1, 1.0), (2, 0.0)]),
    "call": ("abs(-2.0)", [(1, 2.0)]),
    "raise and except": (
        "try:\n  raise KeyError\nexcept KeyError: pass",
        [(1, 0.0), (2, 0.0), (3, 0.0), (3, 0.0)],
    ),
    "return": ("def f(m):\n  return m * 2\nf(1.5)", [(1, 1.5), (2, 3.0), (3, 3.0)]),
    "return a name": ("def f(m):\n  return m\nf(1.5)", [(1, 1.5), (2, 1.5), (3, 1.5)]),
    "bare return": ("def f():\n  return\nf()", [(1, 0.0), (2, 0.0), (3, None)]),
    "lambda": ("f = lambda m: m + 1\nx = f(2.0)", [(1, 3.0), (2, 3.0)]),
    "comprehension": ("x = [i * 2 for i in range(3)]", [(1, [0, 2, 4])]),
    "two on a line": ("x = 1.0; y = x + 1", [(1, 1.0), (1, 2.0)]),
    "global": ("x = 0.0\ndef f(m):\n  global x\n  x = m\nf(2.0)", [(1, 0.0), (2, 2.0), (4, 2.0), (5, None)]),
}


@pytest.mark.parametrize("inline", MODES)
@pytest.mark.parametrize("kind", RECORDED)
def test_each_statement_records_the_expected_events(kind, inline):
    source, events = RECORDED[kind]
    found = [(n, v) for n, v in recorded(source, inline=inline) if not callable(v)]
    assert found == events


@pytest.mark.parametrize("inline", MODES)
def test_yielded_and_sent_generator_values_are_recorded(inline):
    source = """
    def gen():
        x = yield 1.0
        yield x
    g = gen()
    next(g)
    g.send(5.0)
    """
    found = [(n, v) for n, v in recorded(source, inline=inline) if not inspect.isgenerator(v)]
    assert found == [(2, 0.0), (6, 1.0), (3, 5.0), (4, 5.0), (7, 5.0)]


@pytest.mark.parametrize("inline", MODES)
def test_coroutines_and_async_generators_are_recorded(inline):
    source = """
    import asyncio
    async def numbers(n):
        yield n
        return
    async def main(n):
        async for x in numbers(n):
            y = await double(x)
        return y
    async def double(n): return n * 2
    z = asyncio.run(main(2.0))
    """
    assert recorded(source, inline=inline) == [
        (6, 2.0),
        (3, 2.0),
        (4, 2.0),
        (7, 2.0),
        (10, 2.0),
        (10, 4.0),
        (8, 4.0),
        (5, 0.0),
        (9, 4.0),
        (11, 4.0),
    ]


MESSAGES = [
    ("def f(m, extra): pass\nf(2.0, 3.0)", 2.0),
    ("def f(*messages): pass\nf(2.0, 3.0)", (2.0, 3.0)),
    ("class A:\n  def f(self, m): pass\nA().f(2.0)", 2.0),
    ("class A:\n  @classmethod\n  def f(cls, m): pass\nA.f(2.0)", 2.0),
    ("class A:\n  @staticmethod\n  def f(m): pass\nA.f(2.0)", 2.0),
    ("class A:\n  def f(self, __m): 'doc'\nA().f(2.0)", 2.0),
]


@pytest.mark.parametrize("inline", MODES)
@pytest.mark.parametrize(("source", "message"), MESSAGES)
def test_the_header_of_a_function_records_its_message(source, message, inline):
    heads = {
        (node.lineno, node.col_offset): 1
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef)
    }
    assert run(source, heads, inline=inline).events == [(1, message)]


@pytest.mark.parametrize("inline", MODES)
def test_messages_passed_to_lambdas_and_functions_are_also_recorded(inline):
    source = "f = lambda m: m + 1\ndef g(self, a, b): pass\nx = f(2.0)\ng(0, 1.0, 4.0)"
    outcome = run(source, {(1, 4): 1, (1, 14): 2, (2, 15): 3}, inline=inline)
    assert outcome.events == [(1, 2.0), (2, 3.0), (3, 4.0)]
    assert outcome.values["x"] == "3.0"


PUBLISHES = [
    "pub.publish(make(v))",
    "pub.publish(msg=make(v))",
    "pub.publish(*[make(v)])",
    "pub.publish(**{'msg': make(v)})",
    "x = pub.publish(make(v))",
    "(lambda: pub.publish(make(v)))()",
]
PUBLISHER = """
def make(v):
    order.append("made")
    return v
class Pub:
    def publish(self, msg):
        order.append(("published", msg))
pub, v = Pub(), 2.0
"""


@pytest.mark.parametrize("inline", MODES)
@pytest.mark.parametrize("call", PUBLISHES)
def test_publish_call_records_zero_before_the_call(call, inline):
    line = PUBLISHER.count("\n") + 1
    column = call.index("pub.publish") if "lambda" in call else 0
    tree = instrument(ast.parse(PUBLISHER + call), {(line, column): 7}, inline=inline)
    order: list[Any] = []

    def hook(number, value):
        order.append((number, value))
        return value

    exec(bound(code_of(tree, FILE), hook, []), {"order": order})
    assert order == ["made", (7, 0.0), ("published", 2.0)]


@pytest.mark.parametrize("inline", MODES)
def test_the_plan_can_declare_other_calls_as_publishing(inline):
    events: list[Any] = []
    tree = instrument(ast.parse("send(5.0)\n"), {(1, 0): 3}, publishes={3}, inline=inline)
    code = bound(code_of(tree, FILE), lambda n, v: events.append((n, v)) or v, [])
    exec(code, {"send": lambda v: events.append(v)})
    assert events == [(3, 0.0), 5.0]


# Behaviour that instrumentation must not change

PROGRAMS = {
    "truth is asked once": """
class T:
    def __init__(self, v): self.v = v
    def __repr__(self): return "T"
    def __bool__(self):
        asked.append(self.v); return self.v
asked = []
y, n = T(True), T(False)
if y and n or y: pass
if not (y and n): pass
while n or n: pass
assert y or n
def f():
    return y and n
f()
""",
    "docstrings and future imports stay first": '''"""doc"""
from __future__ import annotations
def f(x: undefined):
    """inner"""
    y: also_undefined
class A:
    """of class"""
a, b, c = __doc__, f.__doc__, A.__doc__
f(1)
''',
    "names with two underscores": """
class A:
    __k = 2.0
    def f(self, __m):
        __x = __m * self.__k
        self.__y = __x
        __x += 1
        return __x
z = A().f(3.0)
""",
    "class bodies with a namespace of their own": """
import enum
class Names(dict):
    def __missing__(self, name):
        if name in seen: raise KeyError(name)
        seen.append(name); return name
seen = ["__name__", "print", "x"]
class Meta(type):
    def __prepare__(*_): return Names()
class A(metaclass=Meta):
    x = 1.0
    y = undefined
class Colour(enum.Enum):
    RED = 1.0
    BLUE = enum.auto()
c = list(Colour)
""",
    "slots, dataclasses, properties and super": """
import dataclasses
@dataclasses.dataclass(frozen=True)
class A:
    __slots__ = ("x", "y")
    x: float
    y: list
class B(A):
    def __init__(self, x):
        super().__init__(x, [])
    @property
    def z(self):
        return self.x * 2
b = B(2.0).z
try:
    B(1).x = 3
except dataclasses.FrozenInstanceError as e:
    e2 = str(e)
""",
    "locals stay as they are": """
def f(a):
    b = a * 2.0
    for c in (b,):
        d = lambda: c
    return sorted(locals())
x = f(1.0)
def g():
    yield locals()
y = [sorted(v) for v in g()]
""",
    "finally, else and return": """
out = []
def f(n):
    try:
        if n == 0: return "early"
        if n == 1: raise ValueError(n)
        out.append(n)
    except ValueError as e:
        out.append(str(e)); raise
    else:
        return "else"
    finally:
        out.append("finally")
for n in range(3):
    try: out.append(f(n))
    except ValueError: continue
""",
    "errors over several lines": """
def f(a, b):
    return (a
            / b)
x = f(1,
      2)
f(
  1, 0
)
""",
    "unpacking that fails": "a, b = 1, 2, 3",
    "a name that is not there": "def f():\n    return x\nf()",
    "deleted and unbound": "def f():\n    x = 1.0\n    del x\n    x += 1\nf()",
    "exec and eval in functions": """
def f(a):
    b = a * 2.0
    exec("c = b + 1; out.append(c)", globals(), locals())
    names = {"b": 5.0}
    exec("b = b * 2", names)
    return eval("b - a"), names["b"]
out = []
x = f(1.5)
exec("def g(m):\\n    return m / 0")
try: g(1)
except ZeroDivisionError as e: line = e.__traceback__.tb_next.tb_lineno
class A:
    exec("z = 3.0")
    w = eval("z + 1")
y = A.z, A.w
""",
    "match": """
def f(v):
    match v, 1:
        case [[x, y], 1] if x and y: return x
        case [{"k": z}, _]: return z
        case (1 | 2, _): pass
        case _: return
    return 9
out = [f(v) for v in ([1, 2], {"k": 3}, 1, 2, 7, [0, 1])]
""",
    "multi-line conditions": """
def f(a, b):
    if (a
            and b):
        return (b
                if a
                else 2)
    else:
        b = 1
    while not (
        a
        or b
    ):
        a = (1
             +
             2)
    else:
        b += 1
    return [
        x
        for x in range(a)
    ]
out = [f(x, y) for x in (0, 1) for y in (0, 1)]
""",
}

if sys.version_info >= (3, 12):
    PROGRAMS["type parameters"] = """
def first[T: (int, float), *Ts, **P](items: list[T], *rest: *Ts) -> T:
    x = items[0]
    return x
class Box[T]:
    item: T
    def __init__(self, item: T):
        self.item = item
    def get[S](self, other: S) -> T | S:
        y = self.item or other
        return y
type Pair[T] = tuple[T, T]
type Later = Nowhere
a, b = first([1.0, 2.0]), Box[float](3.0).get("s")
c = [str(p) for p in (*first.__type_params__, *Box.__type_params__, *Pair.__type_params__)]
d = str(Pair.__value__), str(Box[int].__origin__.__name__), first.__annotations__["items"].__args__[0].__name__
Later.__value__
"""


@pytest.mark.parametrize("name", PROGRAMS)
def test_values_errors_and_line_events_are_unchanged(name):
    assert_same(PROGRAMS[name], trace=True)


def monitored(source: str, sites: dict[Offset, int] | None, *, inline: bool) -> list[tuple[str, str, int]]:
    """Return the events of a program that tools on `sys.monitoring` (coverage.py, debuggers) get."""
    monitoring, seen = sys.monitoring, list[tuple[str, str, int]]()
    kinds = monitoring.events
    monitoring.use_tool_id(monitoring.DEBUGGER_ID, "test")

    def told(what: str) -> Any:
        def callback(code: Any, at: int, *_: object) -> None:
            if code.co_filename == FILE:
                seen.append((what, code.co_name, at if what == "line" else 0))

        return callback

    try:
        for what, kind in (("line", kinds.LINE), ("start", kinds.PY_START), ("return", kinds.PY_RETURN)):
            monitoring.register_callback(monitoring.DEBUGGER_ID, kind, told(what))
        monitoring.set_events(monitoring.DEBUGGER_ID, kinds.LINE | kinds.PY_START | kinds.PY_RETURN)
        run(source, sites, inline=inline)
    finally:
        monitoring.set_events(monitoring.DEBUGGER_ID, 0)
        monitoring.free_tool_id(monitoring.DEBUGGER_ID)
    return seen


@pytest.mark.skipif(sys.version_info < (3, 12), reason="sys.monitoring came with Python 3.12")
@pytest.mark.parametrize("name", PROGRAMS)
def test_monitoring_events_are_unchanged(name):
    source = PROGRAMS[name]
    for inline in MODES:
        sites = everywhere(ast.parse(source))
        assert monitored(source, sites, inline=inline) == monitored(source, None, inline=inline)


@pytest.mark.parametrize("inline", MODES)
def test_introspection_sees_the_original_code(inline):
    source = textwrap.dedent(
        '''
        import inspect
        def f(a, b=2, *, c: int = 3):
            """doc"""
            x = a + b
            return x
        def line():
            return inspect.currentframe().f_back.f_lineno
        at = [line(), line(
            )]
        '''
    )
    space: dict[str, Any] = {}
    exec(bound(compiled(source, everywhere(ast.parse(source)), inline=inline), lambda n, v: v, []), space)
    linecache.cache[FILE] = (len(source), None, source.splitlines(keepends=True), FILE)
    assert inspect.getsource(space["f"]) == "".join(source.splitlines(keepends=True)[2:6])
    assert str(inspect.signature(space["f"])) == "(a, b=2, *, c: int = 3)"
    assert space["f"].__code__.co_varnames == ("a", "b", "c", "x")
    assert space["at"] == [9, 9]


def test_positions_without_a_recordable_value_have_no_probe():
    placed: set[Offset] = set()
    instrument(ast.parse("x = 1\nimport os\n"), {(1, 0): 0, (1, 4): 1, (9, 0): 2}, placed=placed)
    assert placed == {(1, 0)}


def test_a_syntax_tree_without_sites_is_unchanged():
    source = PROGRAMS["finally, else and return"]
    assert ast.dump(instrument(ast.parse(source), {})) == ast.dump(ast.parse(source))


# Generated programs

NAMES = st.sampled_from("abc")
SIMPLE = st.sampled_from(["a", "b", "c", "1", "2.5", "0", "-3", "'s'", "[1, 2]", "(a, b)", "None"])
EXPRESSIONS = st.recursive(
    SIMPLE,
    lambda e: st.one_of(
        st.tuples(e, st.sampled_from(["+", "*", "-", "/", "and", "or", "<", "==", "is"]), e).map(
            lambda t: f"({t[0]} {t[1]} {t[2]})"
        ),
        st.tuples(e, e, e).map(lambda t: f"({t[0]} if {t[1]} else {t[2]})"),
        st.tuples(e, e).map(lambda t: f"f({t[0]}, {t[1]})"),
        st.tuples(e, e).map(lambda t: f"({t[0]}\n < {t[1]}\n < 2)"),
        e.map(lambda x: f"not {x}").map(lambda x: f"({x})"),
        e.map(lambda x: f"(lambda q: q or {x})(0)"),
        e.map(lambda x: f"[{x} for i in range(2)]"),
        st.tuples(NAMES, e).map(lambda t: f"({t[0]} := {t[1]})"),
    ),
    max_leaves=5,
)


def block(statements: list[str]) -> str:
    return textwrap.indent("\n".join(statements), "    ")


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    blocks = st.lists(inner, min_size=1, max_size=3).map(block)
    e = EXPRESSIONS
    return st.one_of(
        st.tuples(e, blocks).map(lambda t: f"if {t[0]}:\n{t[1]}"),
        st.tuples(e, blocks, e, blocks, blocks).map(
            lambda t: f"if {t[0]}:\n{t[1]}\nelif {t[2]}:\n{t[3]}\nelse:\n{t[4]}"
        ),
        st.tuples(e, blocks).map(lambda t: f"while tick() and {t[0]}:\n{t[1]}"),
        st.tuples(NAMES, blocks, blocks).map(
            lambda t: f"for {t[0]} in (1.5, 0, 's'):\n{t[1]}\nelse:\n{t[2]}"
        ),
        st.tuples(blocks, blocks, blocks).map(
            lambda t: f"try:\n{t[0]}\nexcept (TypeError, NameError) as error:\n{t[1]}\nfinally:\n{t[2]}"
        ),
        st.tuples(e, NAMES, blocks).map(lambda t: f"with nullcontext({t[0]}) as {t[1]}:\n{t[2]}"),
        st.tuples(NAMES, blocks, e).map(
            lambda t: f"def g({t[0]}, x=a):\n{t[1]}\n    return {t[2]}\na = g(b)"
        ),
        st.tuples(blocks, e).map(lambda t: f"def h():\n{t[0]}\n    yield {t[1]}\nc = list(h())"),
        st.tuples(NAMES, e, blocks).map(
            lambda t: f"class K:\n    {t[0]} = {t[1]}\n{t[2]}\nb = K.__dict__.get('a')"
        ),
        st.tuples(e, blocks, blocks).map(
            lambda t: f"match {t[0]}:\n  case [a, *b] if a:\n{t[1]}\n  case int():\n{t[2]}\n  case _: pass"
        ),
    )


STATEMENTS = st.recursive(
    st.one_of(
        st.tuples(NAMES, EXPRESSIONS).map(lambda t: f"{t[0]} = {t[1]}"),
        st.tuples(NAMES, st.sampled_from(["+=", "-=", "*="]), EXPRESSIONS).map(" ".join),
        st.tuples(NAMES, NAMES, EXPRESSIONS).map(lambda t: f"{t[0]}, *{t[1]} = {t[2]}"),
        st.tuples(NAMES, EXPRESSIONS).map(lambda t: f"{t[0]}: int = {t[1]}; out.append({t[0]})"),
        EXPRESSIONS.map(lambda e: f"out.append(\n  {e}\n)"),
        EXPRESSIONS.map(lambda e: f"d[0] = {e}"),
        EXPRESSIONS.map(lambda e: f"assert {e}, 'message'"),
        NAMES.map(lambda n: f"del {n}"),
        st.sampled_from(["pass", "raise ValueError(a)", "..."]),
    ),
    compound,
    max_leaves=8,
)
PRELUDE = """from contextlib import nullcontext
a, b, c, d, out, ticks = 1.0, 2, "s", {}, [], [0]
def f(x, y):
    return x
def tick():
    ticks[0] += 1
    return ticks[0] < 6
"""


def is_program(source: str) -> bool:
    try:
        compile(source, FILE, "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


@settings(max_examples=200 if SLOW else 60, suppress_health_check=list(HealthCheck))
@given(st.lists(STATEMENTS, min_size=1, max_size=6))
def test_generated_programs_behave_the_same(statements):
    source = PRELUDE + "\n".join(statements) + "\n"
    assume(is_program(source))
    assert_same(source, trace=False)
