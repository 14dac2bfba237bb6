"""Values that are not constant are unknown, and values that are too large are not computed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.python.interpreter import Interpreter
from tarl_lint.workspace.python.values import Several
from tests.lint.workspace.interpreting import interpreted

OPEN = {
    "a name that nothing binds": "r = absent",
    "an environment variable": "import os\nr = os.environ['HOME']",
    "a variable without a default": "import os\nr = os.environ.get('HOME')",
    "an operand": "r = absent + 1",
    "the left operand": "r = 1 + absent",
    "a comparison": "r = absent == 1",
    "a comparison with a list that contains an unknown value": "r = 1 in [absent]",
    "a later comparison of a chain": "r = 1 < 2 < absent",
    "an operand of `or`": "r = 0 or absent",
    "a condition": "r = 1 if absent else 2",
    "an item": "r = [1, 2][absent]",
    "an index out of range": "r = [1][3]",
    "a missing key": "r = {'a': 1}['b']",
    "an item of a number": "r = 3[0]",
    "a slice of a dict": "r = {'a': 1}[0:1]",
    "division by zero": "r = 1 // 0",
    "a text of a number": "r = int('x')",
    "a method that texts do not have": "r = 'a'.absent()",
    "an attribute of a number": "r = (1).real.absent",
    "a call of a number": "r = (3)()",
    "an await": "async def f():\n  pass\nr = (lambda: 3)().absent",
    "the sum of unknown values": "r = sum([1, absent])",
    "the sum of an unknown list": "r = sum(absent)",
    "the length of an unknown list": "r = len(absent)",
    "sorting by unknown keys": "r = sorted([2, 1], key=lambda n: absent)",
    "sorting unknown values": "r = sorted([2, absent])",
    "filtering by an unknown test": "r = list(filter(lambda n: absent, [1]))",
    "a comprehension over an unknown list": "r = [n for n in absent]",
    "a comprehension with an unknown test": "r = [n for n in [1] if absent]",
    "a set of unknown values": "r = {absent}",
    "unpacking too many values": "a, r = [1, 2, 3]",
    "unpacking too few values": "a, r, *b = [1]",
    "unpacking an unknown value": "a, r = absent",
    "an argument that is not given": "def f(a):\n  return a\nr = f()",
    "the text of a list with an unknown value": "r = f'{[absent]}'",
    "the text of a set of texts": 'r = f\'{ {"a", "b"} }\'',
    "the text of an object": "class A:\n  pass\nr = f'{A()}'",
    "the text of a function": "def f():\n  pass\nr = str(f)",
    "the text of an unknown value": "r = f'{absent}'",
    "a format with an unknown width": "r = f'{1:{absent}}'",
    "a format that reads an attribute": "r = '{0.real}'.format(1)",
    "a format that reads an element": "r = '{0[0]}'.format('ab')",
    "joining unknown values": "r = ','.join([absent])",
    "a text with an unknown value": "r = '%s' % absent",
    "an unknown value in place of a function": "r = absent(1)",
    "a library function": "import numpy\nr = numpy.load('x')",
    "an unknown value out of an enumeration": "from enum import Enum\nclass M(Enum):\n  A = 1\nr = M(2)",
    "a key of a dict that is unknown": "r = {'a': 1}.get(absent)",
    "updating with unknown pairs": "d = {}\nr = d.update(absent)",
    "a relative path made absolute": "import os\nr = os.path.abspath('a')",
    "the home folder": "from pathlib import Path\nr = Path('~/x').expanduser()",
    "a recursion without end": "def f(n):\n  return f(n + 1)\nr = f(0)",
    "negating an unknown value": "r = not absent",
    "an order of texts and numbers": "r = 'a' < 1",
    "an order of objects": "class A:\n  pass\nr = A() < A()",
    "super outside a class": "r = super().x",
    "the length of a list with unknown elements": "r = len([1, *absent])",
    "the length of a list that unknown elements were added to": "l = [1]\nl += absent\nr = len(l)",
    "the length of a list that an unknown comprehension was added to": "l = [1]\nl.extend(absent(x) for x in absent)\n"
    "r = len(l)",
    "the length of a sum of lists": "r = len([1] + absent)",
    "an element after unknown ones": "r = [*absent, 1][0]",
    "pairs with unknown elements": "r = list(zip([*absent, 1], 'ab'))",
    "a function for several types": "from functools import singledispatch\n@singledispatch\ndef f(x):\n  return 1\n"
    "r = f(1)",
    "the minor version of Python": "import sys\nr = sys.version_info[1]",
}
STILL_KNOWN = {
    "the major version of Python": ("import sys\nr = sys.version_info[0], sys.version_info.major", (3, 3)),
}


@pytest.mark.parametrize("name", STILL_KNOWN)
def test_a_value_is_known_although_other_values_are_unknown(tmp_path, name):
    text, right = STILL_KNOWN[name]
    assert interpreted(tmp_path, text)["r"] == right


@pytest.mark.parametrize("name", OPEN)
def test_a_value_that_is_not_constant_is_unknown(tmp_path, name):
    assert isinstance(interpreted(tmp_path, OPEN[name])["r"], Unknown)


LARGE = {
    "a text": "r = 'x' * 200_000",
    "a text from the left": "r = 200_000 * 'x'",
    "a list": "r = [0] * 200_000",
    "a sum of lists": "l = [0] * 60_000\nr = l + l",
    "a range": "r = range(200_000)",
    "a filled text": "r = 'a'.zfill(200_000)",
    "an aligned text": "r = 'a'.ljust(200_000)",
    "a width in a format": "r = '%100000d' % 1",
    "a width in a call": "r = '{:100000}'.format(1)",
    "a width in an f-string": "r = f'{1:100000}'",
    "replaced letters": "r = ('a' * 1000).replace('a', 'b' * 1000)",
    "joined texts": "r = ('b' * 1000).join(['a'] * 1000)",
    "a product": "import itertools\nr = list(itertools.product(range(100), repeat=3))",
    "a chain": "import itertools\nl = [0] * 60_000\nr = itertools.chain(l, l)",
    "a sum of many lists": "r = sum([[0] * 1000] * 200, [])",
}


@pytest.mark.parametrize("name", LARGE)
def test_a_value_that_is_too_large_is_not_computed(tmp_path, name):
    assert isinstance(interpreted(tmp_path, LARGE[name])["r"], Unknown)


@pytest.mark.parametrize(
    ("text", "length"),
    [
        ("'x' * 100_000", 100_000),
        ("[0] * 100_000", 100_000),
        ("'a'.zfill(100_000)", 100_000),
        ("list(range(100_000))", 100_000),
        ("'x' * 50_000 + 'y' * 50_000", 100_000),
    ],
)
def test_a_value_of_the_largest_size_is_computed(tmp_path, text, length):
    assert len(interpreted(tmp_path, f"r = {text}")["r"]) == length


def test_large_integers_are_computed_up_to_a_size(tmp_path):
    text = "n = 2\nfor _ in range({}):\n  n *= n\nr = n"
    assert interpreted(tmp_path, text.format(11))["r"] == 2**2048
    assert isinstance(interpreted(tmp_path, text.format(13))["r"], Unknown)


def test_unknown_elements_of_a_list_are_one_unknown_value(tmp_path):
    text = "l = [1]\nl.extend(absent)\nl += absent\nl.append(2)\nk = []\nk.extend({1: 2})"
    found = interpreted(tmp_path, f"{text}\nimport numpy\nk.extend(numpy.ones)")
    assert found["l"] == [1, Several(2, "absent"), Several(3, "absent"), 2]
    assert found["k"] == [1, Several(0, "unknown elements")]


@pytest.mark.parametrize(
    ("text", "steps"),
    [("", 0), ("pass\n" * 5, 5), ("x = 1", 2), ("x = 1 + 2", 4), ("for x in [1, 2]: pass", 8)],
)
def test_each_statement_and_expression_counts_towards_the_step_limit(tmp_path, text, steps):
    path = tmp_path / "read.py"
    path.write_text(text)
    file = Interpreter(path, {})
    before = file.left[0]
    file.run()
    assert before - file.left[0] == steps


PROBLEMS = {
    "a condition": ("if absent:\n    x = 1\nelse:\n    x = 2", 1,
                    "the condition `absent` is not constant; its `else` is not read"),
    "a condition without else": ("if absent:\n    x = 1", 1, "the condition `absent` is not constant"),
    "a check that raises": ("x = 1\nif absent:\n    raise ValueError\nelse:\n    y = 2", 2,
                             "the condition `absent` is not constant"),
    "a loop": ("\nfor x in absent:\n    y = 1", 2, "the loop over `absent` is not constant"),
    "a loop with a condition": ("while absent:\n    y = 1", 1, "the condition `absent` of a loop is not constant"),
    "a case": ("match absent:\n    case 1:\n        x = 1", 2, "the case `1` is not constant"),
    "a case of a kind": ("match 1:\n    case absent():\n        x = 1", 2, "the case `absent()` is not constant"),
    "a guard": ("match 1:\n    case 1 if absent:\n        x = 1", 2, "the case `1` is not constant"),
    "an exception": ("x = 1\nraise ValueError\ny = 2", 2, "it raises an exception here; what follows is not read"),
    "a syntax error": ("x = 1\ny = = 2", 2, "it is not Python 3: invalid syntax"),
    "an endless loop": ("while True:\n    x = 1", 0,
                        "it was read in part: it has too many statements, or nests too deeply"),
}  # fmt: skip


@pytest.mark.parametrize("name", PROBLEMS)
def test_non_constant_code_is_reported_with_its_line(tmp_path, name):
    text, line, reason = PROBLEMS[name]
    path = tmp_path / "read.py"
    path.write_text(text)
    file = Interpreter(path, {})
    file.run()
    assert [(one.file, one.line, one.reason) for one in file.problems] == [(path, line, reason)]


def test_unknown_condition_takes_a_branch_that_does_not_raise(tmp_path):
    kept = interpreted(
        tmp_path,
        "x = y = 0\nif absent:\n    x = 1\nelse:\n    x = 2\nif absent:\n    raise E\nelse:\n    y = 3",
    )
    assert (kept["x"], kept["y"]) == (1, 3)


def test_functions_of_the_file_can_be_called(tmp_path):
    path = tmp_path / "read.py"
    path.write_text(
        "def f(a, b=2):\n    return a + b\ndef g():\n    raise E\ndef h():\n    return h()\nx = 1\n"
    )
    file = Interpreter(path, {})
    file.run()
    assert file.called("f", 1) == 3
    assert file.called("x") == Unknown(0, "x")
    assert file.called("absent") == Unknown(0, "absent")
    assert file.called("g") == Unknown(3, "g")
    assert [(one.line, one.reason) for one in file.problems] == [(4, "g raises an exception here")]
    assert isinstance(file.called("h"), Unknown)


def test_imported_module_is_interpreted_once(tmp_path):
    (tmp_path / "one.py").write_text("import two\nX = two.Y + 1\n_z = 5\nN.append(1)\n")
    (tmp_path / "two.py").write_text("Y = __name__\nN = []\nif absent:\n    Y = 1\n")
    path = tmp_path / "read.py"
    path.write_text(
        "import one, two\nfrom two import *\nfrom two import Y as y, none\nimport far.away as f\n"
        "r = [one.X, two.Y, y, f]"
    )
    asked: list[str] = []

    def found(name: str) -> Path | None:
        asked.append(name)
        return next((one for one in [tmp_path / f"{name}.py"] if one.is_file()), None)

    file = Interpreter(path, {}, found)
    names = file.run()
    assert names["r"] == [2, 1, 1, Library("far.away")]
    assert (names["Y"], names["N"], names["none"]) == (1, [], Library("two.none"))
    assert [(one.file.name, one.line) for one in file.problems] == [("two.py", 3)]
