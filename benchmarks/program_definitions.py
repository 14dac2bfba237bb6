"""The functions and classes of random programs. NAME and other words in capitals are placeholders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

DEFINITIONS: Final[Mapping[str, str]] = {
    "convert": """\
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
    "guarded": """\
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
    "matched": """\
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
    "counted": """\
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
    "generated": """\
def NAME(texts):
    for index, text in enumerate(texts):
        if not text:
            continue
        yield f'{text}{index}'
        if index > LAST:
            return
    yield from ('end' for _ in range(1))
""",
    "rotated": """\
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
    "sliced": """\
def NAME(numbers):
    values = list(numbers)
    values[1:2] = [7, 8]
    del values[0]
    values.insert(0, STEP)
    stream = iter(values)
    pairs = list(zip(*[stream] * 2))
    return [a + b for a, b in pairs] + list(stream)
""",
    "grouped": """\
def NAME(texts):
    found = defaultdict(list)
    for text in texts:
        found[text[:1]].append(text)
    found.setdefault('none', []).extend(['x'] * STEP)
    return found
""",
    "merged": """\
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
    "Shape": """\
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
""",
    "Record": """\
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
""",
    "Level": """\
class NAME(IntEnum):
    LOW = 1
    MID = auto()
    HIGH = TOP
""",
    "Colour": """\
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
    "Flags": """\
class NAME(enum.Flag):
    NONE = 0
    A = auto()
    B = auto()
    C = auto()
    BOTH = A | B
""",
    "Index": """\
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
    "managed": """\
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
    "Planet": """\
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
    "Configured": """\
@dataclass
class NAME:
    kind: str
    factor: dataclasses.InitVar[float] = STEP
    total: float = field(init=False, repr=False)
    parts: list = field(default_factory=lambda: [1, 2])
    def __post_init__(self, factor):
        self.total = factor * sum(self.parts)
""",
    "Layout": """\
class NAME(list):
    def long(self):
        return [t for t in self if len(t) > STEP]
    def add(self, text):
        self.append(text)
        return self
    def __getattr__(self, name):
        raise AttributeError(name)
""",
    "Lookup": """\
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
    "Countdown": """\
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
    "Celsius": """\
class NAME(float):
    unit = 'C'
    def __str__(self):
        return f'{float(self):.1f} {self.unit}'
    def warmer(self, by=STEP):
        return type(self)(self + by)
""",
    "Mode": """\
class NAME(Enum):
    IDLE = 'idle'
    DRIVE = 'drive'
    ALIAS = 'idle'
    @property
    def label(self):
        return {NAME.IDLE: 'I', NAME.DRIVE: 'D'}[self] + self.value
    WRITTEN
""",
}  # fmt: skip
