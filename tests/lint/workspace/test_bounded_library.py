"""Functions of Python's library that might take long or need much memory have unknown results, and end at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tarl_lint.workspace.python.builtin_functions import BUILTINS
from tarl_lint.workspace.python.evaluator import Unknown
from tarl_lint.workspace.python.interpreter import Interpreter
from tarl_lint.workspace.python.libraries import LIBRARIES
from tarl_lint.workspace.python.methods import METHODS
from tarl_lint.workspace.python.paths import FilePath

LONG = "'" + "a" * 4_000 + "'"
COSTLY = {
    "a nested repeat": f"import re\nr = re.match(r'(a+)+$', {LONG} + 'b')",
    "alternatives in a repeat": f"import re\nr = re.search(r'^(a|ab?|aa)*$', {LONG} + 'c')",
    "many repeats": f"import re\nr = re.search(r'.*.*.*.*.*x', {LONG})",
    "many optional parts": f"import re\nr = re.match('a?' * 40 + 'a' * 40, {LONG})",
    "a nested repeat in a look-ahead": f"import re\nr = re.match(r'(?=(a+)+$)', {LONG} + 'b')",
    "a replacement that grows": f"import re\nr = re.sub('a', 'b' * 90_000, {LONG})",
    "a long pattern": "import re\nr = re.compile('a' * 3_000)",
    "an invalid pattern": "import re\nr = re.compile('(')",
    "the list of an endless iterator": "import itertools\nr = list(itertools.count())",
    "the end of an endless iterator": "import itertools\nr = max(itertools.repeat(1))",
    "a test of an endless iterator": "import itertools\nr = any(itertools.repeat(0))",
    "a filter of an endless iterator": "import itertools\nr = next(filter(None, itertools.cycle([0])))",
    "a slice of an endless iterator": "import itertools\nr = list(itertools.islice(itertools.count(), 10**9))",
    "many combinations": "import itertools\nr = list(itertools.permutations(range(30)))",
    "a product of many": "import itertools\nr = list(itertools.product(range(999), repeat=9))",
    "a large factorial": "import math\nr = math.factorial(10**7)",
    "a large power": "r = pow(10, 10**9)",
    "a large shift": "r = 1 << 10**9",
    "a large product": "import math\nr = math.prod([2**4000] * 900)",
    "a wide format": "r = f'{1:>99999999}'",
    "a large template": "from string import Template\nr = Template('$a' * 1000).substitute(a='b' * 1000)",
    "a large translation": "r = ('a' * 1000).translate({97: 'b' * 1000})",
    "a large indentation": "import textwrap\nr = textwrap.indent('a\\n' * 1000, 'b' * 1000)",
    "a large counter": "from collections import Counter\nr = list(Counter(a=10**12).elements())",
    "a wide tab": "r = '\\t'.expandtabs(10**9)",
    "large bytes": "r = bytes(10**9)",
    "a text of an endless nesting": "x = []\nx.append(x)\nr = str(x)",
    "an object that contains itself": "class A:\n  def __str__(self):\n    return str(self)\nr = str(A())",
    "an address": "class A:\n  pass\nr = str(A())",
    "a hash of an unknown value": "r = {absent: 1}[2]",
}


def interpreted(folder: Path, text: str) -> Any:
    path = folder / "read.py"
    path.write_text(text, encoding="utf-8")
    return Interpreter(path, {}).run().get("r", Unknown(0, "nothing"))


@pytest.mark.parametrize("name", COSTLY)
def test_calls_that_might_take_long_have_unknown_results(tmp_path, name):
    assert isinstance(interpreted(tmp_path, COSTLY[name]), Unknown)


KNOWN = {
    "a usual pattern on a long text": (f"import re\nr = len(re.sub('[^a]+', '_', {LONG}))", 4_000),
    "a nested repeat on a short text": ("import re\nr = re.match(r'(\\w+,)+', 'a,b,c').group()", "a,b,"),
    "the first elements of an endless generator": (
        "def f():\n  n = 0\n  while True:\n    yield n\n    n += 1\nr = [a for a, _ in zip(f(), 'abc')]",
        [0, 1, 2],
    ),
    "an endless iterator that a loop leaves": (
        "import itertools\nfor n in itertools.count(3):\n  if n > 5:\n    break\nr = n",
        6,
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_cheap_calls_have_known_results(tmp_path, name):
    text, right = KNOWN[name]
    assert interpreted(tmp_path, text) == right


ARGUMENTS = (
    "", "1", "-1", "0", "2.5", "None", "True", "''", "'a('", "'{0'", "'%('", "'a b'", "[]", "[1, 'a']", "{}",
    "{'a': 1}",
    "()", "('a', 1)", "{1}", "b'a'", "absent", "lambda x: absent", "lambda *a: 1 // 0", "range(3)", "iter([1])",
    "E.A", "D()", "float('nan')", "'a', 'b'", "'a', ['a']", "[1], 'a'", "str, [1, None]", "lambda *a: a, ['b', 1]",
    "'(a', 'b'", "'a', r'\\g<9>', 'a'", "'a', lambda m: m.group(3), 'aa'", "[1, 2], 0", "'ab', 2", "{'a': []}, 'a'",
    "[3, 'x'], 1, 2", "*[1] * 5", "'a', b=absent", "[D()], key=absent", "(" + "'(' * 300" + ")",
)  # fmt: skip
START = """
import enum, dataclasses
class E(enum.Enum):
    A = 'a'
@dataclasses.dataclass
class D:
    x: int = 1
"""
FUNCTIONS = sorted({*BUILTINS, *LIBRARIES, "getattr", "setattr", "vars", "property", "dataclasses.asdict",
                    "operator.itemgetter", "operator.attrgetter", "functools.partial", "functools.wraps"})  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_bounded_library_functions_never_fail(tmp_path, name):
    start = f"{START}import {name.split('.')[0]}\n" if "." in name else START
    if "." in name:
        start += f"import {name.rpartition('.')[0]}\n"
    calls = "\n".join(f"r.append({name}({one}))" for one in ARGUMENTS)
    assert len(interpreted(tmp_path, f"{start}r = []\n{calls}\n")) == len(ARGUMENTS)


VALUES = (
    "'a{0}'", "b'a'", "(3)", "(2.5)", "[1, 'a']", "(1, 2)", "{'a': 1}", "{1, 2}", "range(4)", "collections.deque([1])",
    "collections.Counter('aab')", "collections.OrderedDict(a=1)", "collections.ChainMap({'a': 1})",
    "collections.defaultdict(list)", "re.compile('(a)(b)?')", "re.match('(a)(b)?', 'a')", "string.Template('$a ${')",
    "pathlib.Path('/a/b.c')", "string.Formatter()",
)  # fmt: skip
NAMES = sorted({name for names in METHODS.values() for name in names} | {"parse", *FilePath.readable})


@pytest.mark.parametrize("value", VALUES)
def test_bounded_library_methods_never_fail(tmp_path, value):
    start = f"{START}import collections, re, string, pathlib\nr = []\n"
    calls = [f"r.append({value}.{name}({one}))" for name in NAMES for one in ARGUMENTS]
    found = interpreted(tmp_path, start + "\n".join(calls) + "\n")
    assert len(found) == len(calls)
