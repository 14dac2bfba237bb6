"""Expressions of random programs: numbers, texts, lists and dicts."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from program_objects import Objects


class Expressions(Objects):
    """Writes random expressions. `number`, `text`, `texts`, `numbers` and `table` return expressions of these types."""

    def __init__(self, source: random.Random) -> None:
        super().__init__(source)
        self.depth = 0

    def one(self, simple: Sequence[Callable[[], str]], more: Sequence[Callable[[], str]]) -> str:
        """Return an expression in one of several forms; if it is deeply nested, the form is simple."""
        self.depth += 1
        try:
            return self.random.choice(simple if self.depth > 3 else [*simple[:1], *more])()
        finally:
            self.depth -= 1

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
        """Return an expression for use in an f-string: without quotes and backslashes, for Python 3.11."""
        return text if not set("'\\{}!:") & set(text) else "(1 + 2)"

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
