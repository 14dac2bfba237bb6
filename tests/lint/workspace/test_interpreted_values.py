"""Constant expressions and statements have the values that Python computes; all others are unknown."""

from __future__ import annotations

from typing import Any

import pytest

from tests.lint.workspace.interpreting import interpreted

EXPRESSIONS = """
    7 // 2, -7 // 2, 7 % 3, 2 - 5, 3 * 4, 9 / 2, 6 & 3, 6 | 3, 6 ^ 3
    -3, +3, not 3, not 0, ~3
    1 < 2, 2 < 2, 2 <= 2, 3 <= 2, 3 > 2, 2 > 2, 2 >= 2, 1 >= 2, 1 == 1.0, 1 != 1, 1 == "1"
    1 < 2 < 3, 1 < 3 < 2, 3 > 2 >= 2
    1 in [1, 2], 3 in (1, 2), 3 not in {"a": 1}, "b" in "abc", "x" not in "abc", "a" in {"a": 0}
    None is None, [1][0] is not None, "a".lower() is None
    0 or "x", 1 or "x", 0 and "x", 1 and "x", "" or [] or {}, 1 and 2 and 0
    "yes" if 1 < 2 else "no", "yes" if "" else "no"
    "ab" + "cd", "ab" * 3, 3 * "ab", [1] * 2 + [2], (1,) + (2, 3), "ab" * -1
    "%s-%03d %.1f%%" % ("a", 7, 2.5), "%s" % "x", "%(k)s" % {"k": 1}
    "{}-{:>4}-{k!r}".format("a", 7, k="b")
    f"{1 + 1}|{'a'!r}|{2.5:.2f}|{'x':>{3}}|{'é'!s}|{True}"
    "a,b".split(","), "a b".rsplit(), "a-b-c".partition("-"), "a-b-c".rpartition("-"), "a\\nb".splitlines()
    " a ".strip(), " a ".lstrip(), " a ".rstrip(), "aB".swapcase(), "ab".title(), "ab".capitalize(), "AB".casefold()
    "abcb".replace("b", "x"), "abcb".find("b"), "abcb".rfind("b"), "abcb".count("b")
    "12".isdigit(), "1a".isdigit(), "ab".isalpha(), "a1".isalnum(), "12".isnumeric()
    "abc".startswith("ab"), "abc".endswith("ab"), "abc".removeprefix("a"), "abc".removesuffix("c")
    "7".zfill(3), "a".ljust(3, "."), "a".rjust(3), "a".center(5, "*"), "-".join(["a", "b"]), "aB".lower(), "aB".upper()
    [1, 2, 3][0], [1, 2, 3][-1], "abc"[1], (1, 2)[1], {"a": 5}["a"], {1: 2}[1]
    [1, 2, 3, 4][1:3], [1, 2, 3, 4][::2], "abcd"[:-1], (1, 2, 3)[1:], [1, 2, 3][::-1]
    [*[1, 2], 3, *(4,)], (*"ab",), {**{"a": 1}, "a": 2, "b": 3}
    [x * y for x in range(3) for y in range(3) if x < y if y > 1]
    {k: v for k, v in [("a", 1), ("b", 2)] if v > 1}
    list(x for x in (1, 2)), sorted({3, 1, 3}), sorted({x % 2 for x in range(5)})
    len([1, 2]), len("abc"), len({"a": 1}), len(())
    list(range(2, 9, 3)), list(range(3, 0, -1)), min(3, 1), max([3, 1]), abs(-4), round(2.567, 1), divmod(7, 2)
    any([0, 1]), any([]), all([1, 0]), all([]), ord("a"), chr(98), repr("x"), str(3), int("4"), float("2.5"), bool([])
    sum([1, 2]), sum([1, 2], 10), sum([[1], [2]], [])
    sorted([3, 1, 2]), sorted([3, 1, 2], reverse=True), sorted(["bb", "a"], key=len), list(reversed([1, 2]))
    list(enumerate("ab")), list(enumerate("ab", 1)), list(zip([1, 2], "abc")), list(map(str, [1, 2])), list(iter([1]))
    list(map(lambda a, b: a + b, [1, 2], [10, 20]))
    list(filter(None, [0, 1, ""])), list(filter(lambda n: n > 1, [1, 2]))
    dict([("a", 1)], b=2), dict({"a": 1}), dict(a=1), tuple([1]), list("ab")
    [1, 2, 1].index(2), [1, 2, 1].count(1), (1, 2).index(2), (1, 1).count(1), [1].copy()
    {"a": 1}.get("a"), {"a": 1}.get("b"), {"a": 1}.get("b", 5), list({"a": 1}.items()), list({"a": 1}.keys())
    list({"a": 1}.values()), {"a": 1}.copy(), [n for n in {"a": 1}]
    isinstance(1, int), isinstance(1, (str, float)), isinstance([], list), isinstance((), (tuple, dict)), type(1) is int
    type("a") == str, type(2.0) is int
    (lambda a, b=2: a * b)(3), (lambda *a, **k: (a, k))(1, x=2)
    [y := 3, y + 1], [last := n for n in range(3)], (n := 5) + n
    sum(b"ab"), list(b"ab"), b"ab"[0], len(b"ab"), "é".encode(), b"ab".decode()
    len(f"{'a':>20}"), "a" "b", 1_000, 0x10, b"ab"
"""


@pytest.mark.parametrize("text", [line.strip() for line in EXPRESSIONS.strip().split("\n")])
def test_an_expression_has_the_value_that_python_computes(tmp_path, text):
    real: dict[str, Any] = {}
    exec(f"r = [{text}]", real)
    found = interpreted(tmp_path, f"r = [{text}]")["r"]
    assert found == real["r"]
    assert [*map(type, found)] == [*map(type, real["r"])]


PROGRAMS = """\
# chained and unpacked targets
a = b = 1; (c, [d, *e]) = 2, [3, 4, 5]; *f, g = 'xyz'
r = [a, b, c, d, e, f, g]
# items and slices of lists and dicts
l = [1, 2]; l[0] = 5; d = {}; d['k'] = 1; d[2] = 3
r = [l, d]
# augmented
a = 1; a += 2; a *= 5; s = 'x'; s += 'y'; l = [1]; k = l; l += (2,); d = {'n': 1}; d['n'] -= 4
r = [a, s, l, k, d]
# annotated
a: int = 3
b: int
r = a
# deleted
d = {'a': 1, 'b': 2}
del d['a']
r = d
# if and elif
r = []
for n in range(4):
    if n == 0:
        r.append('z')
    elif n < 3:
        r.append(n)
    else:
        r += ['many']
# for with else and break
r = []
for n in [1, 2, 3]:
    if n == 2:
        break
    r.append(n)
else:
    r.append('no')
for n in []:
    pass
else:
    r.append('else')
# while with else
n, r = 0, []
while n < 3:
    n += 1
    if n == 2:
        continue
    r.append(n)
else:
    r.append('e')
# while with break
n = 0
while True:
    n += 1
    if n > 4:
        break
else:
    n = 100
r = n
# nested loops
r = []
for a in range(3):
    for b in range(3):
        if b == a:
            break
        r.append((a, b))
# return in a loop
def f():
    for n in range(9):
        if n * n > 10:
            return n
r = [f(), (lambda: None)()]
# defaults
def f(a, b=2, *, c=3, d):
    return a, b, c, d
r = [f(1, d=4), f(1, 5, d=6, c=7)]
# positional only
def f(a, b=1, /, c=2):
    return a, b, c
r = [f(0), f(0, 9), f(0, 9, 8)]
# star arguments
def f(a, *rest, k=0, **more):
    return a, rest, k, more
r = [f(1), f(1, 2, 3, k=4, x=5), f(*[1, 2], **{'y': 6})]
# defaults of lambdas in a loop
fs = [lambda n=n: n for n in range(3)]
r = [f() for f in fs]
# closure
def outer(x):
    def inner(y):
        return x + y
    return inner
r = outer(1)(2)
# nonlocal of two levels
def outer():
    n = 0
    def middle():
        def inner():
            nonlocal n
            n += 1
        inner()
    middle(); middle()
    return n
r = outer()
# global
n = 1
def f():
    global n, m
    n = 5
    m = 6
f()
r = [n, m]
# local names stay local
n = 1
def f():
    n = 5
    return n
r = [f(), n]
# walrus in a comprehension
def f():
    found = [last := n for n in range(3)]
    return found, last
r = f()
# comprehension variables stay inside
n = 7
l = [n for n in range(3)]
r = n
# generator
def f():
    yield 1
    yield from [2, 3]
r = list(f())
# generator with return
def f(n):
    if n:
        return
    yield 1
r = [list(f(0)), list(f(1))]
# no generator in spite of an inner one
def f():
    def g():
        yield 1
    return list(g())
r = f()
# try
r = []
try:
    r.append(1)
except ValueError:
    r.append(2)
else:
    r.append(3)
finally:
    r.append(4)
# raise and except
r = []
try:
    r.append(1)
    raise ValueError('x')
except ValueError as e:
    r.append(2)
finally:
    r.append(4)
# raise in a function
def f():
    try:
        raise ValueError
    finally:
        r.append('f')
r = []
try:
    f()
except ValueError:
    r.append('caught')
# return through finally
def f():
    try:
        return 1
    finally:
        r.append(2)
r = []
r.append(f())
# match
r = []
for s in (1, 'a', None, 'other', True):
    match s:
        case 1 | 2:
            r.append('number')
        case None:
            r.append('none')
        case 'a' as letter:
            r.append(letter)
        case x if x == 'other':
            r.append(x * 2)
        case _:
            r.append('rest')
# match without a case
r = 0
match 5:
    case 6:
        r = 1
    case 5 if r:
        r = 2
# class attribute set later
class A:
    n = 1
A.n += 1
A.m = 5
r = [A.n, A().m]
# class and static methods
class A:
    n = 2
    @classmethod
    def c(cls, k):
        return cls.n * k
    @staticmethod
    def s(k):
        return k + 1
class B(A):
    n = 5
r = [A.c(3), B.c(3), B().c(1), A.s(1), A().s(2)]
# property and method
class A:
    def __init__(self, n):
        self.n = n
    @property
    def twice(self):
        return 2 * self.n
    def plus(self, k=1):
        return self.n + k
a = A(4)
a.n = 6
f = a.plus
r = [a.twice, a.plus(), f(2), A.plus(a, 3)]
# super over two levels
class A:
    def f(self):
        return ['A']
class B(A):
    pass
class C(B):
    def f(self):
        return super().f() + ['C']
r = C().f()
# base after the first
class A:
    a = 1
class B:
    b = 2
    a = 9
class C(A, B):
    pass
r = [C.a, C.b, C().b]
# isinstance of own classes
class A:
    pass
class B(A):
    pass
class C:
    pass
r = [isinstance(B(), A), isinstance(A(), B), isinstance(C(), (B, A)), isinstance(3, A), type(B()) is B,
     type(B()) is A]
# equality of objects
class A:
    pass
a, b = A(), A()
r = [a == a, a == b, a != b, a is a, a is not b, A is A, len == len]
# data class
from dataclasses import dataclass, field
@dataclass
class A:
    x: int
    y: int = 2
    z: list = field(default_factory=list)
    w: int = field(default=7)
@dataclass()
class B(A):
    v: str = 'v'
a, b = A(1), A(1, 5)
a.z.append(3)
c = B(9, v='u')
r = [a.x, a.y, a.z, a.w, b.y, b.z, c.x, c.w, c.v]
# after the start of a data class
from dataclasses import dataclass
@dataclass
class A:
    x: int
    def __post_init__(self):
        self.y = self.x + 1
r = A(2).y
# named tuples
from typing import NamedTuple
from collections import namedtuple
class P(NamedTuple):
    x: int
    y: int = 5
Q = namedtuple('Q', ['a', 'b'])
p, q = P(1), Q(3, b=4)
x, y = p
r = [p.x, p.y, p[1], x, y, list(q), q[-1], q[0:1]]
# enumeration
from enum import Enum, IntEnum
class M(Enum):
    A = 'a'
    B = 'b'
    def up(self):
        return self.value.upper()
class N(IntEnum):
    ONE = 1
r = [M.A.value, M.B.name, M('b').name, M['A'].value, [m.name for m in M], M.A is M('a'), M.A == M.B, M.B.up(),
     N.ONE.value]
# imports
import os.path, math as m
from os import path as p, sep
import itertools
r = [os.path.join('a', 'b'), m.pi, p.basename('/x/y.z'), sep, list(itertools.chain('a', 'b')),
     list(itertools.chain.from_iterable(['ab', 'c'])), list(itertools.product('ab', repeat=2)),
     p.dirname('/x/y'), p.isabs('/x')]
# partial
from functools import partial
def f(a, b, c=0):
    return a, b, c
g = partial(f, 1, c=5)
r = [g(2), g(b=3), g(2, c=6)]
# methods that read iterators
from collections import Counter, deque
c, d, l, s, m = Counter('ab'), deque([1]), [1], {1}, {}
c.update(x for x in 'abc'); c.subtract(iter('b')); d.extend(map(int, '23')); d.extendleft(iter([0]))
l.extend(n for n in (2, 3)); s.update(iter([4])); m.update(zip('ab', (1, 2)))
r = [c, list(d), l, sorted(s), m, ','.join(str(n) for n in l), s.union(n for n in [9]) == {1, 4, 9}]
# sorted lists in place
r = [3, 1, 2]
r.sort()
r.sort(key=lambda n: -n)
r.reverse()
r.insert(1, 9)
r.extend((7, 8))
r.remove(9)
r.append(r.pop(0))
# dicts in place
d = {'a': 1}
d.update({'b': 2}, c=3)
d.update([('e', 5)])
x = d.setdefault('a', 9), d.setdefault('z', 8)
y = d.pop('b'), d.pop('none', 0)
r = [d, x, y]
e = {1: 2}
e.clear()
r.append(e)
# copies
import copy
a = {'l': [1], 't': (2, [3])}
b = copy.deepcopy(a)
a['l'].append(9)
a['t'][1].append(8)
r = b
# ordered dict
from collections import OrderedDict
r = list(OrderedDict([('b', 1), ('a', 2)]).items())
# functions as values
def f(g, n):
    return [g(k) for k in range(n)]
r = [f(str, 2), list(map(f, [abs], [2])), sorted([2, 1], key=lambda n: n)]
# names
r = [__name__ == '__main__', len(__file__) > 0]
# string of paths
from pathlib import Path
p = Path('/a/b/../c.tar.gz')
r = [str(p.parent), p.name, p.stem, p.suffix, p.suffixes, str(p / 'd'), str(p.with_name('x')),
     str(p.with_suffix('.y')), p.is_absolute(), [str(q) for q in Path('/a/b/c').parents],
     str(Path('/a/b/c').parents[1]), p.as_posix(), str(Path('/a', 'b').joinpath('c', 'd')), Path('/a/b').parts,
     f'{Path("x")}', str(Path('/a/b/c').relative_to('/a')), str(Path('b').expanduser())]
"""
STATEMENTS = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("# ").split("\n# "))


@pytest.mark.parametrize("name", STATEMENTS)
def test_statements_have_the_effect_that_python_gives_them(tmp_path, name):
    real: dict[str, Any] = {"__name__": "__main__", "__file__": "x"}
    exec(STATEMENTS[name], real)
    assert interpreted(tmp_path, STATEMENTS[name])["r"] == real["r"]
