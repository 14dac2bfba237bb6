"""Compare how TARL interprets random Python programs, executing nothing, with what Python computes.

    python benchmarks/interpreted_programs.py [--count 2000] [--seed 0] [--show 3]

Each program uses the parts of Python that launch files compute values with: regular expressions, collections,
itertools, data classes, enumerations, classes with special methods, generators, patterns of `match`, exceptions,
paths. All of its values are constant, so each result has to be known and equal to Python's. Python executes only
programs that this script makes.
"""

from __future__ import annotations

import argparse
import itertools
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tarl_lint.workspace.python.interpreter import Interpreter

IMPORTS = """\
import collections, contextlib, copy, dataclasses, enum, functools, itertools, json, math, operator, os, re, string
import textwrap
from collections import ChainMap, Counter, OrderedDict, defaultdict, deque, namedtuple
from dataclasses import asdict, astuple, dataclass, field, replace
from enum import Enum, IntEnum, auto
from functools import partial, reduce
from pathlib import Path, PurePosixPath
from string import Template
from typing import NamedTuple
"""
NAMES = ("scan", "arm_left", "arm_right", "base-2", "Wheel7", "lidar", "tilt pan", "gps0", "cam_3", "")


class Programs:
    """Writes random programs. `number`, `text`, `texts`, `numbers` and `table` return expressions of these types."""

    def __init__(self, source: random.Random) -> None:
        self.random = source
        self.depth = 0
        self.definitions: list[str] = []
        self.made = 0

    def program(self) -> str:
        """Return a program whose results are the elements of the list `r`."""
        kinds = (self.number, self.text, self.texts, self.numbers, self.table)
        results = []
        for _ in range(self.random.randint(3, 6)):
            before = len(self.definitions)
            value = self.random.choice(kinds)()
            results += [*self.definitions[before:], f"r.append({value})"]
        return "\n".join([IMPORTS, "r = []", *results]) + "\n"

    def name(self, kind: str) -> str:
        """Return a new name."""
        self.made += 1
        return f"{kind}{self.made}"

    def one(self, simple: Sequence[Callable[[], str]], more: Sequence[Callable[[], str]]) -> str:
        """Return an expression of one of several forms; a simple one where it is nested deeply."""
        self.depth += 1
        try:
            return self.random.choice(simple if self.depth > 3 else [*simple[:1], *more])()
        finally:
            self.depth -= 1

    def word(self) -> str:
        """Return a text."""
        return repr(self.random.choice(NAMES))

    def small(self) -> str:
        """Return a small number."""
        return str(self.random.randint(1, 4))

    # numbers

    def number(self) -> str:
        """Return a number."""
        one, text, texts, numbers, table = self.number, self.text, self.texts, self.numbers, self.table
        simple = [lambda: str(self.random.randint(-9, 30)), lambda: str(self.random.randint(-20, 40) / 4)]
        more = [
            lambda: f"len({texts()})",
            lambda: f"len({text()})",
            lambda: f"sum({numbers()})",
            lambda: f"max({numbers()}, default=0)",
            lambda: f"min({texts()}, key=len, default='').count('a')",
            lambda: f"round({one()} * {one()} + {one()}, 2)",
            lambda: f"({one()} if {self.test()} else {one()})",
            lambda: f"Counter({text()})[{self.word()}[:1]]",
            lambda: f"Counter({texts()}).total() if hasattr(Counter, 'total') else len({texts()})",
            lambda: f"reduce(lambda a, b: a + b, {numbers()}, {one()})",
            lambda: f"reduce(operator.add, {numbers()}, 0)",
            lambda: f"next(iter({numbers()}), {one()})",
            lambda: f"next((n for n in {numbers()} if n > {one()}), -1)",
            lambda: f"math.floor({one()}) // {self.small()}",
            lambda: f"int({one()}) % {self.small()}",
            lambda: f"round(math.hypot({one()}, {one()}), 3)",
            lambda: f"{self.converted()}({text()})",
            lambda: f"({self.shape()}).area()",
            lambda: f"len({self.shape()})",
            lambda: f"abs({self.shape()})",
            lambda: f"{self.planet()}.mass",
            lambda: f"len({self.layout()})",
            lambda: f"{self.lookup()}['scan']",
            lambda: f"{self.celsius()} + {one()}",
            lambda: f"{self.configured()}.total",
            lambda: f"({self.shape()}).size",
            lambda: f"{self.level()} + {one()}",
            lambda: f"{self.level()}.value * {one()}",
            lambda: f"max({self.record()}, {self.record()}).speed",
            lambda: f"replace({self.record()}, speed={one()}).speed",
            lambda: f"{self.point()}._replace(x={one()}).x",
            lambda: f"{self.point()}[1] - {self.point()}.x",
            lambda: f"({table()}).get({self.word()}, {one()})",
            lambda: f"ChainMap({table()}, {table()}).get({self.word()}, {one()})",
            lambda: f"{self.matched()}({self.subject()})",
            lambda: f"len({texts()}) and {one()}",
            lambda: f"deque({numbers()} + [{one()}], maxlen={self.small()})[-1]",
            lambda: f"{self.counted()}({one()})",
            lambda: f"(lambda *a, k={one()}, **o: k + len(a) + len(o))({one()}, z={one()})",
            lambda: f"int(re.sub(r'\\D', '', {text()})[:5] or 0)",
            lambda: f"({self.flags()}).value",
            lambda: f"len({self.index()})",
            lambda: f"sum(len(k) for k in {self.index()})",
            lambda: f"partial(pow, {self.small()})({self.small()})",
            lambda: f"sum(x * y for x, y in zip({numbers()}, {numbers()}))",
            lambda: f"operator.itemgetter(-1)({numbers()} + [{one()}])",
        ]
        return self.one(simple, more)

    def test(self) -> str:
        """Return a condition."""
        simple = [lambda: f"{self.number()} < {self.number()}", lambda: f"{self.text()}"]
        more = [
            lambda: f"any(n > {self.number()} for n in {self.numbers()})",
            lambda: f"all(map(str.isalnum, {self.texts()}))",
            lambda: f"{self.text()} in {self.texts()}",
            lambda: f"re.match({self.pattern()!r}, {self.text()})",
            lambda: f"isinstance({self.shape()}, object)",
            lambda: f"not {self.numbers()}",
            lambda: f"{self.record()} == {self.record()}",
            lambda: f"{self.record()} < {self.record()}",
            lambda: f"{self.word()} in {self.shape()}",
            lambda: f"{self.level()} is {self.level()}",
            lambda: f"{self.colour()} == {self.word()}",
            lambda: f"{self.word()} in {self.index()}",
            lambda: f"-3 < {self.number()} <= {self.number()}",
            lambda: f"set({self.texts()}) & set({self.texts()})",
            lambda: f"set({self.numbers()}) <= set({self.numbers()})",
            lambda: f"(found := {self.number()}) > 0 and found < 9",
        ]
        return self.one(simple, more)

    # texts

    def pattern(self) -> str:
        """Return a regular expression."""
        return self.random.choice(
            (
                r"[a-z]+",
                r"(\w)(\d*)",
                r"[_ -]+",
                r"(?P<kind>[a-zA-Z]+)[_-]?(?P<index>\d+)?",
                r"\d",
                r"^\w+$",
                r"a|e|i",
            )
        )

    def text(self) -> str:
        """Return a text."""
        one, number, texts = self.text, self.number, self.texts
        simple = [self.word, lambda: f"str({self.random.randint(0, 99)})"]
        more = [
            lambda: f"f'{{{self.inner(number())}}}/{{{self.inner(one())}}}'",
            lambda: f"f'{{{self.inner(number())}:>6.1f}}|{{{self.inner(one())}!r:<8}}'",
            lambda: f"'{self.random.choice('_/, ')}'.join({texts()})",
            lambda: f"re.sub({self.pattern()!r}, {self.random.choice(('', '_', '<'))!r}, {one()})",
            lambda: rf"re.sub(r'(\w)(\w)', r'\2\1', {one()}, count={self.small()})",
            lambda: f"re.sub(r'[a-z]', lambda m: m.group().upper(), {one()})",
            lambda: f"(m.group(0) if (m := re.search({self.pattern()!r}, {one()})) else {one()})",
            lambda: f"Template('$a-${{b}}').substitute(a={one()}, b={number()})",
            lambda: f"Template('$a $missing').safe_substitute({{'a': {one()}}})",
            lambda: f"textwrap.dedent('''\\\n    x\n      {self.random.choice('abc')}\n    ''') + {one()}",
            lambda: f"textwrap.shorten({one()} + ' and more words', width=14, placeholder='~')",
            lambda: f"os.path.join('/data', {one()}, 'x.yaml')",
            lambda: f"os.path.splitext({one()} + '.tar.gz')[{self.random.choice('01')}]",
            lambda: f"os.path.relpath('/a/b/' + {one()}, '/a/c')",
            lambda: f"str(Path('/opt') / {one()} / 'cfg.yml')",
            lambda: f"Path('/opt/v1', {one()} + '.py').with_suffix('.xml').name",
            lambda: f"PurePosixPath('a/b', {one()}).parent.as_posix()",
            lambda: f"str({self.shape()})",
            lambda: f"f'{{{self.inner(self.shape())}}}:{{{self.inner(self.record())}}}'",
            lambda: f"repr({self.shape()}[:2])",
            lambda: f"str({self.shape()}.KNOWN)",
            lambda: f"max(type({self.planet()}), key=lambda p: p.mass).title",
            lambda: f"repr({self.configured()})",
            lambda: f"format({self.shape()}, {self.random.choice(('u', ''))!r})",
            lambda: f"repr({self.record()})",
            lambda: f"repr({self.point()})",
            lambda: f"f'{{{self.level()}.name:*^12}}'",
            lambda: f"str({self.mode()})",
            lambda: f"{self.lookup()}.get({self.word()}, {one()})",
            lambda: f"str({self.celsius()})",
            lambda: f"next({self.countdown()}, 'none')",
            lambda: f"({self.layout()} or ['x'])[0]",
            lambda: f"{self.mode()}.label",
            lambda: f"json.dumps({self.table()}, sort_keys=True)",
            lambda: f"type({self.shape()}).__name__.lower()",
            lambda: f"getattr({self.record()}, {self.random.choice(('name', 'missing'))!r}, {one()})",
            lambda: f"string.capwords({one()})",
            lambda: f"{one()}.partition('_')[{self.random.choice('012')}]",
            lambda: f"{one()}.translate(str.maketrans('-_ ', '...'))",
            lambda: f"'%s=%05.2f' % ({one()}, {number()})",
            lambda: f"'{{}}:{{x:>4}}'.format({one()}, x={number()})",
            lambda: f"({one()} or {one()})[::-1]",
            lambda: f"functools.reduce(lambda a, b: f'{{a}}.{{b}}', {texts()}, 'r')",
            lambda: f"operator.methodcaller('replace', 'a', {one()})({one()})",
            lambda: f"({texts()} or ['none'])[0].title()",
            lambda: f"max({texts()} or ['z'], key=lambda t: (len(t), t))",
            lambda: f"os.path.commonprefix({texts()} or [''])",
            lambda: f"{self.guarded()}({self.table()}, {one()})",
            lambda: f"{self.managed()}({texts()})",
            lambda: f"{self.colour()}.value",
            lambda: f"{self.colour()}.upper()",
            lambda: f"str({self.index()}[{one()}])",
            lambda: f"({self.flags()}).name or {one()}",
        ]
        return self.one(simple, more)

    @staticmethod
    def inner(text: str) -> str:
        """Return an expression for the inside of an f-string, without quotes and backslashes, for Python 3.11."""
        return text if not set("'\\{}!:") & set(text) else "(1 + 2)"

    # lists

    def texts(self) -> str:
        """Return a list of texts."""
        one, number, text = self.texts, self.number, self.text
        simple = [
            lambda: f"[{', '.join(self.word() for _ in range(self.random.randint(0, 4)))}]",
            lambda: f"{self.word()}.split('_')",
        ]
        more = [
            lambda: f"[t.strip('_') for t in {one()} if t]",
            lambda: (
                f"sorted({one()}, key=lambda t: (len(t), t), reverse={self.random.choice(('True', 'False'))})"
            ),
            lambda: f"sorted(set({one()}))",
            lambda: f"sorted(set({one()}) {self.random.choice('&|-^')} set({one()}))",
            lambda: f"list(map(str.upper, {one()}))",
            lambda: f"list(map(str, {self.numbers()}))",
            lambda: f"list(filter(None, {one()}))",
            lambda: f"re.findall(r'[a-z]+', {text()})",
            lambda: f"re.split(r'[_ -]', {text()})",
            lambda: f"[m['kind'] for m in re.finditer(r'(?P<kind>[a-z]+)\\d*', {text()})]",
            lambda: f"[a + b for a, b in itertools.product({one()}[:3], 'xy')]",
            lambda: f"[''.join(p) for p in itertools.combinations({text()}[:5], 2)]",
            lambda: f"['/'.join(p) for p in itertools.pairwise({one()})]",
            lambda: f"list(itertools.chain({one()}, {one()}))",
            lambda: f"list(itertools.islice(itertools.cycle({one()} + ['z']), {self.small()}))",
            lambda: f"[k for k, g in itertools.groupby(sorted({one()}), key=lambda t: t[:1])]",
            lambda: f"[k for k, _ in Counter({text()}).most_common({self.small()})]",
            lambda: f"list(OrderedDict.fromkeys({one()}))",
            lambda: f"list({self.table()})",
            lambda: f"[f'{{i}}{{t}}' for i, t in enumerate({one()}, {self.small()})]",
            lambda: f"[*{one()}, *{one()}]",
            lambda: f"list({self.generator()}({one()}))",
            lambda: f"{self.rotated()}({one()}, {number()})",
            lambda: f"[level.name.lower() for level in type({self.level()})]",
            lambda: f"[name for name, *_ in [t.split('_') for t in {one()}]]",
            lambda: f"[y for t in {one()} if (y := t.lower())]",
            lambda: f"{one()}[{self.random.choice(('::-1', '1:', ':-1', '::2'))}]",
            lambda: f"list(reversed({one()}))",
            lambda: f"textwrap.wrap({text()} + ' one two three', 8)",
            lambda: f"[str(p) for p in Path('/a/b/c').parents][:{self.small()}]",
            lambda: f"[x for x in {self.shape()}]",
            lambda: f"{self.layout()}.long()",
            lambda: f"list({self.countdown()})",
            lambda: f"sorted({self.lookup()})",
            lambda: f"[a + b for a, b in zip({self.countdown()}, {one()})]",
            lambda: f"{self.layout()} + {one()}",
            lambda: f"[t for t in {self.layout()}][1:]",
            lambda: "[key for _, key, _, _ in string.Formatter().parse('{a}-{b:>3}c')]",
            lambda: f"list(asdict({self.configured()}))",
            lambda: f"[operator.attrgetter('name')(q) for q in sorted([{self.record()}, {self.record()}])]",
            lambda: f"list(itertools.takewhile(len, {one()}))",
            lambda: f"[t for t, keep in zip({one()}, itertools.cycle([True, False])) if keep]",
            lambda: f"list(dict(zip({one()}, itertools.count())).keys())",
        ]
        return self.one(simple, more)

    def numbers(self) -> str:
        """Return a list of numbers."""
        one, number = self.numbers, self.number
        simple = [
            lambda: (
                f"[{', '.join(str(self.random.randint(-5, 20)) for _ in range(self.random.randint(0, 4)))}]"
            ),
            lambda: f"list(range({self.small()}))",
        ]
        more = [
            lambda: f"[len(t) for t in {self.texts()}]",
            lambda: f"[n * {number()} for n in {one()} if n]",
            lambda: f"sorted({one()}, key=lambda n: -n)",
            lambda: f"list(itertools.accumulate({one()}))",
            lambda: f"list(itertools.accumulate({one()}, max))",
            lambda: f"[a - b for a, b in zip({one()}, {one()})]",
            lambda: f"[a + b for a, b in itertools.zip_longest({one()}, {one()}, fillvalue=0)]",
            lambda: f"list(Counter({self.texts()}).values())",
            lambda: f"list(astuple({self.record()}))[1:2]",
            lambda: f"list({self.point()})",
            lambda: f"[int(d) for d in re.findall(r'\\d', {self.text()})]",
            lambda: f"[*map(lambda a, b: a + b, {one()}, {one()})]",
            lambda: f"list(itertools.starmap(max, zip({one()}, {one()})))",
            lambda: f"[x for row in [{one()}, {one()}] for x in row]",
            lambda: f"[level.value for level in type({self.level()}) if level > 1]",
            lambda: f"copy.deepcopy({one()}) + [{number()}]",
            lambda: f"{self.sliced()}({one()})",
            lambda: f"list(filter(lambda n: n % 2, {one()}))",
            lambda: f"sorted({{n % 3 for n in {one()}}})",
            lambda: f"[bool({self.test()}) + 0]",
            lambda: f"[a for a, *_ in {self.pairs()}]",
        ]
        return self.one(simple, more)

    def pairs(self) -> str:
        """Return a list of pairs."""
        return f"list(zip({self.numbers()}, {self.texts()}))"

    def table(self) -> str:
        """Return a dict with texts as keys."""
        one, number = self.table, self.number
        simple = [lambda: f"{{'a': {self.random.randint(0, 9)}}}", lambda: "dict(scan=1, gps0=2.5)"]
        more = [
            lambda: f"{{t: len(t) for t in {self.texts()}}}",
            lambda: f"dict(zip({self.texts()}, {self.numbers()}))",
            lambda: f"dict(Counter({self.texts()}))",
            lambda: f"{{**{one()}, 'k': {number()}}}",
            lambda: f"({one()} | {one()})",
            lambda: f"dict(ChainMap({one()}, {one()}))",
            lambda: f"json.loads(json.dumps({one()}))",
            lambda: f"{{k: v for k, v in sorted({one()}.items(), key=lambda kv: kv[0])}}",
            lambda: f"{{str(n): n for n in {self.numbers()} if n != {number()}}}",
            lambda: f"{{k: len(v) for k, v in {self.grouped()}({self.texts()}).items()}}",
            lambda: f"{self.point()}._asdict()",
            lambda: f"{{k: v for k, v in asdict({self.record()}).items() if isinstance(v, (int, float))}}",
            lambda: f"{{f.name: 1 for f in dataclasses.fields({self.record()})}}",
            lambda: f"{{level.name: level.value for level in type({self.level()})}}",
            lambda: f"dict.fromkeys({self.texts()}, {number()})",
            lambda: f"{self.merged()}({one()}, {one()})",
        ]
        return self.one(simple, more)

    # definitions

    def define(self, kind: str, text: str, **parts: str) -> str:
        """Add a definition, in which NAME and the names of the parts are replaced; return its name."""
        name = self.name(kind)
        for key, part in {**parts, "NAME": name}.items():
            text = text.replace(key, part)
        self.definitions.append(textwrap_dedent(text))
        return name

    def converted(self) -> str:
        """Return the name of a function with `try`, `else` and `finally`."""
        return self.define(
            "convert",
            """
            def NAME(text):
                try:
                    return int(text)
                except ValueError as error:
                    return len(str(type(error).__name__))
                else:
                    return -1
                finally:
                    r.append('tried')
            """,
        )

    def guarded(self) -> str:
        """Return the name of a function with exceptions of its own."""
        return self.define(
            "guarded",
            """
            class NAMEError(KeyError):
                pass
            def NAME(table, key):
                with contextlib.suppress(KeyError, IndexError):
                    return str(table[key])
                try:
                    if KIND:
                        raise NAMEError(key)
                    return [][0]
                except NAMEError:
                    return 'own'
                except (LookupError, ValueError) as e:
                    return type(e).__name__
            """,
            KIND=self.random.choice(("key", "not key", "table")),
        )

    def matched(self) -> str:
        """Return the name of a function with `match`."""
        return self.define(
            "matched",
            """
            def NAME(value):
                match value:
                    case []:
                        return 0
                    case ['scan', *rest]:
                        return len(rest) + 10
                    case [str() as first, second]:
                        return len(first) + len(second)
                    case {'kind': 'arm', 'size': size}:
                        return size
                    case {'kind': kind, **others} if others:
                        return len(kind) + len(others)
                    case str(text) if text.startswith('a'):
                        return 20
                    case 'gps0' | 'lidar' | '':
                        return 30
                    case int(n) | float(n):
                        return n + 0.5
                    case None | True | False:
                        return 40
                return 99
            """,
        )

    def subject(self) -> str:
        """Return a value for `match`."""
        return self.random.choice((
            self.texts(), self.text(), self.number(), "None", "{'kind': 'arm', 'size': 3}",
            f"{{'kind': {self.word()}, 'x': 1}}", "{'kind': 'x'}", "('scan', 1, 2)", f"[{self.word()}, {self.word()}]",
        ))  # fmt: skip

    def counted(self) -> str:
        """Return the name of a function with a closure and an endless iterator."""
        return self.define(
            "counted",
            """
            def NAMEmake():
                total = 0
                def inner(value):
                    nonlocal total
                    total += value
                    return round(total, 2)
                return inner
            NAMEadd = NAMEmake()
            def NAME(value):
                NAMEadd(STEP)
                for turn in itertools.count(1):
                    if turn > 3:
                        break
                    NAMEadd(turn)
                else:
                    return -1
                return NAMEadd(value)
            """,
            STEP=self.small(),
        )

    def generator(self) -> str:
        """Return the name of a generator."""
        return self.define(
            "generated",
            """
            def NAME(texts):
                for index, text in enumerate(texts):
                    if not text:
                        continue
                    yield f'{text}{index}'
                    if index > LAST:
                        return
                yield from ('end' for _ in range(1))
            """,
            LAST=self.small(),
        )

    def rotated(self) -> str:
        """Return the name of a decorated function."""
        return self.define(
            "rotated",
            """
            def NAMEcalls(function):
                @functools.wraps(function)
                def wrapper(*args, **keywords):
                    return [*function(*args, **keywords), function.__name__[:4]]
                return wrapper
            @NAMEcalls
            def NAME(texts, by):
                found = deque(texts)
                found.rotate(int(by))
                found.appendleft('first')
                if len(found) > 3:
                    found.pop()
                return found
            """,
        )

    def sliced(self) -> str:
        """Return the name of a function with slices and iterators."""
        return self.define(
            "sliced",
            """
            def NAME(numbers):
                values = list(numbers)
                values[1:2] = [7, 8]
                del values[0]
                values.insert(0, STEP)
                stream = iter(values)
                pairs = list(zip(*[stream] * 2))
                return [a + b for a, b in pairs] + list(stream)
            """,
            STEP=self.small(),
        )

    def grouped(self) -> str:
        """Return the name of a function with a defaultdict."""
        return self.define(
            "grouped",
            """
            def NAME(texts):
                found = defaultdict(list)
                for text in texts:
                    found[text[:1]].append(text)
                found.setdefault('none', []).extend(['x'] * STEP)
                return found
            """,
            STEP=self.small(),
        )

    def merged(self) -> str:
        """Return the name of a function with an OrderedDict."""
        return self.define(
            "merged",
            """
            def NAME(one, other):
                found = OrderedDict(one)
                for key, value in other.items():
                    if key in found:
                        found[key] += value
                    else:
                        found[key] = value
                if found:
                    found.move_to_end(next(iter(found)))
                return dict(found)
            """,
        )

    def shape(self) -> str:
        """Return an object of a class with special methods."""
        name = self.define("Shape", """
            class NAMEBase:
                count = 0
                def __init__(self, name, *parts):
                    self._name = name
                    self.parts = list(parts)
                    type(self).count += 1
                @property
                def size(self):
                    return len(self.parts) + self.EXTRA
                @size.setter
                def size(self, value):
                    self.parts = ['p'] * int(value)
                def __str__(self):
                    return f'{self._name}({len(self)})'
                def __format__(self, spec):
                    return self._name.upper() if spec == 'u' else str(self)
                def __len__(self):
                    return len(self.parts)
                def __iter__(self):
                    return iter(self.parts)
                def __contains__(self, item):
                    return item in self.parts
                def __getitem__(self, key):
                    match key:
                        case slice():
                            return self.parts[key]
                        case int() as index:
                            return self.parts[index % len(self.parts)]
                    raise TypeError(key)
                def __abs__(self):
                    return len(self._name)
                def __init_subclass__(cls, **given):
                    cls.KNOWN = {cls.__name__[:5]: given.get('kind', 'plain')}
                def __add__(self, other):
                    return type(self)(self._name, *self.parts, *other.parts)
                def area(self):
                    return self.size * STEP
            class NAME(NAMEBase, kind='sub'):
                EXTRA = STEP
                def area(self):
                    return super().area() + 1
                @classmethod
                def named(cls, name):
                    return cls(name, name[:1], name[-1:])
                @staticmethod
                def unit():
                    made = NAME('unit')
                    made.size = STEP
                    return made
            """, STEP=self.small())  # fmt: skip
        return self.random.choice((
            f"{name}({self.word()}, {self.word()})", f"{name}.named({self.text()})", f"{name}.unit()",
            f"({name}('a', 'b') + {name}.unit())",
        ))  # fmt: skip

    def record(self) -> str:
        """Return an object of a data class."""
        known = [one for one in self.definitions if "class Record" in one]
        if known:
            name = known[0].split("class Record")[1].split(":")[0]
            name = f"Record{name}"
        else:
            name = self.define("Record", """
                @dataclass(order=True, frozen=FROZEN)
                class NAME:
                    speed: float
                    name: str = field(default='base', compare=True)
                    tags: list = field(default_factory=list, compare=False)
                    def __post_init__(self):
                        self.tags.append(self.name[:1])
                    @functools.cached_property
                    def long(self):
                        return self.name * 2
                """, FROZEN=self.random.choice(("True", "False")))  # fmt: skip
        return self.random.choice((
            f"{name}({self.number()})", f"{name}({self.number()}, {self.text()})",
            f"{name}(name={self.word()}, speed={self.number()}, tags=[{self.word()}])",
        ))  # fmt: skip

    def point(self) -> str:
        """Return a named tuple."""
        name = self.define("Point", self.random.choice((
            "NAME = namedtuple('NAME', 'x y', defaults=[2])",
            """
            class NAME(NamedTuple):
                x: float
                y: float = 1.5
            """,
        )))  # fmt: skip
        return self.random.choice((f"{name}({self.number()})", f"{name}({self.number()}, y={self.number()})",
                                   f"{name}(*[{self.number()}, {self.number()}])"))  # fmt: skip

    def level(self) -> str:
        """Return a member of a numeric enumeration."""
        name = self.define(
            "Level",
            """
            class NAME(IntEnum):
                LOW = 1
                MID = auto()
                HIGH = TOP
            """,
            TOP=str(self.random.randint(4, 9)),
        )
        return self.random.choice((f"{name}.LOW", f"{name}['MID']", f"{name}(1)", f"max({name})"))

    def colour(self) -> str:
        """Return a member of an enumeration of texts."""
        name = self.define(
            "Colour",
            """
            class NAME(str, Enum):
                RED = 'red'
                SCAN = 'scan'
                @classmethod
                def parse(cls, text):
                    for member in cls:
                        if member.startswith(text[:1]):
                            return member
                    return cls.RED
            """,
        )
        return self.random.choice((f"{name}.RED", f"{name}('scan')", f"{name}.parse({self.text()})"))

    def flags(self) -> str:
        """Return a combination of flags."""
        name = self.define(
            "Flags",
            """
            class NAME(enum.Flag):
                NONE = 0
                A = auto()
                B = auto()
                C = auto()
                BOTH = A | B
            """,
        )
        return self.random.choice((
            f"{name}.A | {name}.C", f"{name}.BOTH & {name}.B", f"{name}.BOTH",
            f"({name}.A if {name}.B in {name}.BOTH else {name}.C)", f"({name}.NONE or {name}.C)",
        ))  # fmt: skip

    def index(self) -> str:
        """Return an object of a class that is a container."""
        name = self.define(
            "Index",
            """
            class NAME:
                def __init__(self, *pairs):
                    self._table = {}
                    for key, value in pairs:
                        self[key] = value
                def __setitem__(self, key, value):
                    self._table[key.lower()] = value
                def __getitem__(self, key):
                    return self._table.get(key.lower(), DEFAULT)
                def __delitem__(self, key):
                    del self._table[key]
                def __len__(self):
                    return len(self._table)
                def __iter__(self):
                    yield from sorted(self._table)
                def __contains__(self, key):
                    return key.lower() in self._table
                def __getattr__(self, name):
                    return f'no {name}'
            """,
            DEFAULT=self.small(),
        )
        return f"{name}(*{self.pairs_of_texts()})"

    def pairs_of_texts(self) -> str:
        """Return a list of pairs that begin with a text."""
        return f"list(zip({self.texts()}, {self.numbers()}))"

    def managed(self) -> str:
        """Return the name of a function with context managers."""
        return self.define(
            "managed",
            """
            class NAMEBlock:
                def __enter__(self):
                    self.log = ['enter']
                    return self
                def __exit__(self, *reason):
                    self.log.append('exit')
            @contextlib.contextmanager
            def NAMEscope(log, name):
                log.append(f'<{name}')
                try:
                    yield name.upper()
                finally:
                    log.append(f'{name}>')
            def NAME(texts):
                log = []
                for text in texts:
                    with NAMEscope(log, text) as upper, NAMEBlock() as block:
                        block.log.append(upper)
                        if len(log) > STEP:
                            return ' '.join(log + block.log)
                        if not text:
                            continue
                    log += block.log
                return ' '.join(log)
            """,
            STEP=self.small(),
        )

    def planet(self) -> str:
        """Return a member of an enumeration whose members have attributes."""
        name = self.define(
            "Planet",
            """
            class NAME(Enum):
                A = ('a', 2.5)
                B = ('b', STEP)
                def __init__(self, label, mass):
                    self.mass = mass
                    self.title = label.upper()
                def next(self):
                    members = list(type(self))
                    return members[(members.index(self) + 1) % len(members)]
            """,
            STEP=self.small(),
        )
        return self.random.choice((f"{name}.A", f"{name}(('a', 2.5))", f"{name}.B.next()"))

    def configured(self) -> str:
        """Return an object of a data class with arguments that are no fields."""
        name = self.define(
            "Configured",
            """
            @dataclass
            class NAME:
                kind: str
                factor: dataclasses.InitVar[float] = STEP
                total: float = field(init=False, repr=False)
                parts: list = field(default_factory=lambda: [1, 2])
                def __post_init__(self, factor):
                    self.total = factor * sum(self.parts)
            """,
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.word()})", f"{name}({self.word()}, {self.number()})"))

    def layout(self) -> str:
        """Return an object of a class that is a list."""
        name = self.define(
            "Layout",
            """
            class NAME(list):
                def long(self):
                    return [t for t in self if len(t) > STEP]
                def add(self, text):
                    self.append(text)
                    return self
                def __getattr__(self, name):
                    raise AttributeError(name)
            """,
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.texts()})", f"{name}().add({self.text()}).add('last')"))

    def lookup(self) -> str:
        """Return an object of a class that is a dict."""
        name = self.define(
            "Lookup",
            """
            class NAME(dict):
                asked = []
                def __init__(self, *pairs, **given):
                    super().__init__(pairs, **given)
                    self.order = list(self)
                def __missing__(self, key):
                    NAME.asked.append(key)
                    return f'no {key} of {len(self.order)}'
                def __setitem__(self, key, value):
                    super().__setitem__(key, str(value))
            """,
        )
        return self.random.choice((f"{name}(scan={self.word()})", f"{name}(('a', 'b'), c={self.text()})"))

    def countdown(self) -> str:
        """Return an object of a class that is an iterator."""
        name = self.define(
            "Countdown",
            """
            class NAME:
                made = 0
                def __new__(cls, *args):
                    cls.made += 1
                    return super().__new__(cls)
                def __init__(self, start):
                    self.left = start
                def __iter__(self):
                    return self
                def __next__(self):
                    if self.left <= 0:
                        raise StopIteration
                    self.left -= 1
                    return f'{self.left}-{NAME.made}'
            """,
        )
        return f"{name}({self.small()})"

    def celsius(self) -> str:
        """Return an object of a class that is a number."""
        name = self.define(
            "Celsius",
            """
            class NAME(float):
                unit = 'C'
                def __str__(self):
                    return f'{float(self):.1f} {self.unit}'
                def warmer(self, by=STEP):
                    return type(self)(self + by)
            """,
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.small()})", f"{name}('2.5').warmer()"))

    def mode(self) -> str:
        """Return a member of an enumeration."""
        name = self.define("Mode", """
            class NAME(Enum):
                IDLE = 'idle'
                DRIVE = 'drive'
                ALIAS = 'idle'
                @property
                def label(self):
                    return {NAME.IDLE: 'I', NAME.DRIVE: 'D'}[self] + self.value
                WRITTEN
            """, WRITTEN=self.random.choice((
                "def __str__(self): return self.value.upper()", "steps = property(lambda self: 2)")))  # fmt: skip
        return self.random.choice((f"{name}.IDLE", f"{name}('drive')", f"{name}.ALIAS", f"list({name})[-1]"))


def textwrap_dedent(text: str) -> str:
    """Return a text without common indentation and outer empty lines."""
    import textwrap

    return textwrap.dedent(text).strip("\n")


def compared(text: str, folder: Path) -> tuple[int, list[str]]:
    """Return the number of results of a program, and a line for each that TARL reads differently from Python.

    Raises SyntaxError and what the program raises.
    """
    real: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(text, "program", "exec"), real)  # noqa: S102 - only programs of this script
    path = folder / "program.py"
    path.write_text(text, encoding="utf-8")
    interpreter = Interpreter(path, {})
    found = interpreter.run().get("r", [])
    wrong = [f"{problem.line}: {problem.reason}" for problem in interpreter.problems]
    results = list(real["r"])
    for index, right in enumerate(results):
        ours = found[index] if isinstance(found, list) and index < len(found) else "nothing"
        if type(ours) is not type(right) or ours != right or repr(ours) != repr(right):
            wrong.append(f"result {index}: {ours!r:.300} instead of {right!r:.300}")
    return len(results), wrong


def main() -> None:
    """Print the number of programs and results, and the differences."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=2_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--show", type=int, default=3)
    typed = parser.parse_args()
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in itertools.count():
            if total["programs"] == typed.count:
                break
            text = Programs(random.Random(typed.seed * 1_000_000 + number)).program()
            try:
                results, wrong = compared(text, Path(folder))
            except (
                ArithmeticError,
                LookupError,
                TypeError,
                ValueError,
                AttributeError,
                SyntaxError,
            ) as error:
                total["raise an exception in Python"] += 1
                if typed.show < 0:
                    print(f"program {number}: {error!r}")
                continue
            total["programs"] += 1
            total["results"] += results
            total["right programs"] += not wrong
            total["wrong results"] += len(wrong)
            if wrong and total["shown"] < typed.show:
                total["shown"] += 1
                print(f"program {number}\n{text}\n" + "\n".join(wrong), file=sys.stderr)
    right, programs, wrong_results = total["right programs"], total["programs"], total["wrong results"]
    print(f"{right} of {programs} programs right, {wrong_results} of {total['results']} results wrong")
    print(f"{total['raise an exception in Python']} further programs raise an exception in Python")


if __name__ == "__main__":
    main()
