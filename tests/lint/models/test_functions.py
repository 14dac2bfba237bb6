"""Each function of the standard library and of ROS that has a model of its own has an exact test here."""

from __future__ import annotations

import pytest

from tarl_lint.catalog import IN_THREADS
from tarl_lint.models.behaviour_trees import CHECKS, COMPARISON, COMPOSITES, CONSTANTS, DECORATORS
from tarl_lint.models.blackboards import CLIENTS, GETTERS, SETTERS
from tarl_lint.models.element_trees import SUBELEMENTS, TREES
from tarl_lint.models.files_by_path import OPENING, READING, RESOLVING, WRITING
from tarl_lint.models.files_by_path import PATHS as PATH_CLASSES
from tarl_lint.models.library_functions import BUILTIN
from tarl_lint.models.smach import MACHINES
from tests.lint.models.marked import differing, in_callback

QUEUES = [
    f"{module}.{name}"
    for module in ("queue", "Queue", "asyncio", "multiprocessing")
    for name in ("Queue", "LifoQueue", "PriorityQueue", "SimpleQueue", "JoinableQueue")
]
WHERE = {
    "deque": "collections.deque",
    "OrderedDict": "collections.OrderedDict",
    "defaultdict": "collections.defaultdict",
    "Counter": "collections.Counter",
    "ChainMap": "collections.ChainMap",
    "namedtuple": "collections.namedtuple",
    "operator.attrgetter.<made>": "operator.attrgetter",
    "operator.itemgetter.<made>": "operator.itemgetter",
}  # function → how a program obtains it, if not by the name of its entry
AWAITABLE = [f"asyncio.{name}" for name in ("run", "create_task", "ensure_future", "wait_for", "shield")]
NAMES = ("rospy.resolve_name", "rospy.remap_name", "rospy.names.resolve_name")
PATHS = ("rospy.names.ns_join", "roslib.names.ns_join", "os.path.join", "posixpath.join")
CONTAINERS = ("StateMachine", "Sequence", "Concurrence", "Container")
TREE = """
        class Test(py_trees.behaviour.Behaviour):
            def update(self):
                return py_trees.common.Status.SUCCESS if msg.data > 1.0 else py_trees.common.Status.FAILURE
        class Far(py_trees.behaviour.Behaviour):
            def update(self):
                out.publish(2.0)  # MARK
                return py_trees.common.Status.SUCCESS
"""


def in_tree(mark: str, body: str) -> str:
    """Return the behaviours `Test` and `Far`, with the mark at the publish call of `Far`, and a body."""
    return TREE.replace("MARK", mark) + body


# function(s) → the body of a callback, in which NAME is the function
CASES: dict[tuple[str, ...], str] = {
    ("os.environ.get", "os.getenv", "os.environ.setdefault", "os.environ.pop"): """
        out.publish(NAME("RATE", msg.data))  # data
        out.publish(NAME("RATE", 1.0))  # clean
        out.publish(NAME("RATE", "fast"))  # clean
        out.publish(NAME(msg.name, "fast"))  # data
    """,
    OPENING: """
        with NAME("/tmp/a.txt", "w") as f:
            f.write(msg.text)
        with NAME("/tmp/a.txt") as f:
            out.publish(f.read())  # data
        with NAME("/tmp/b.txt") as f:
            out.publish(f.read())  # clean
    """,
    (*PATH_CLASSES, *RESOLVING): """
        with open(NAME("/tmp/a.txt"), "w") as f:
            f.write(msg.text)
        out.publish(open("/tmp/a.txt").read())  # data
        out.publish(open(NAME("/tmp/b.txt")).read())  # clean
    """,
    tuple(WRITING): """
        import cv2, numpy
        NAME("/tmp/a.npy", msg.data)
        out.publish(numpy.load("/tmp/a.npy"))  # data
        out.publish(cv2.imread("/tmp/b.npy"))  # clean
    """,
    READING: """
        import numpy
        numpy.save("/tmp/a.npy", msg.data)
        out.publish(NAME("/tmp/a.npy"))  # data
        out.publish(NAME("/tmp/b.npy"))  # clean
    """,
    ("list", "tuple", "deque"): """
        kept = NAME([0.0, msg.data])
        out.publish(kept[1])  # data
        out.publish(kept[0])  # clean
        out.publish(len(kept))  # clean
        out.publish(len(NAME(msg.items)))  # data
    """,
    ("iter",): """
        out.publish(next(NAME([msg.data])))  # data
        out.publish(next(NAME([1.0])))  # clean
    """,
    ("reversed",): """
        kept = NAME([0.0, msg.data])
        out.publish(kept[0])  # data
        out.publish(kept[1])  # clean
    """,
    ("set", "frozenset"): """
        kept = NAME([0.0, msg.data])
        out.publish(kept.pop())  # data
        out.publish(len(kept))  # data
        out.publish(NAME([0.0, 1.0]).pop())  # clean
        out.publish(len(NAME([0.0, 1.0])))  # clean
    """,
    ("sorted",): """
        out.publish(NAME([0.0, msg.data])[0])  # data
        out.publish(NAME([0.0, 1.0])[0])  # clean
        out.publish(NAME([0.0, 1.0], key=lambda v: v * msg.data)[0])  # control
    """,
    tuple(QUEUES): """
        full, other = NAME(), NAME()
        full.put(msg.data)
        other.put(0.0)
        out.publish(full.get())  # data
        out.publish(other.get())  # clean
        out.publish(full.qsize())  # clean
    """,
    ("eval",): """
        near, far = msg.data, 1.0
        out.publish(NAME("near * 2"))  # data
        out.publish(NAME("far * 2"))  # clean
        out.publish(NAME(msg.text))  # data
    """,
    ("csv.writer", "csv.DictWriter"): """
        import io
        stream, other = io.StringIO(), io.StringIO()
        rows = NAME(stream)
        rows.writerow([msg.data])
        NAME(other).writerow([1.0])
        out.publish(stream.getvalue())  # data
        out.publish(other.getvalue())  # clean
    """,
    TREES: """
        import io
        import xml.etree.ElementTree as trees
        root, stream, other = trees.Element("a", value=str(msg.data)), io.StringIO(), io.StringIO()
        NAME(root).write(stream)
        NAME(trees.Element("b")).write(other)
        out.publish(stream.getvalue())  # data
        out.publish(other.getvalue())  # clean
    """,
    SUBELEMENTS: """
        import xml.etree.ElementTree as trees
        root, other = trees.Element("a"), trees.Element("b")
        NAME(root, "c").text = msg.data
        NAME(other, "c").text = "x"
        out.publish(trees.tostring(root))  # data
        out.publish(trees.tostring(other))  # clean
    """,
    ("ChainMap",): """
        first, second = {}, {"a": 0.0, "b": 0.0}
        both = NAME(first, second)
        first["a"] = msg.data
        out.publish(both["a"])  # data
        out.publish(both["b"])  # clean
    """,
    ("weakref.WeakSet",): """
        class Part:
            def __init__(self):
                self.x, self.y = msg.data, 1.0
        kept = NAME()
        kept.add(Part())
        for part in kept:
            out.publish(part.x)  # data
            out.publish(part.y)  # clean
    """,
    ("weakref.WeakValueDictionary", "weakref.WeakKeyDictionary"): """
        kept = NAME()
        kept["a"], kept["b"] = msg.data, 1.0
        out.publish(kept["a"])  # data
        out.publish(kept["b"])  # clean
    """,
    ("dict", "OrderedDict"): """
        kept = NAME({"a": msg.data}, b=0.0)
        out.publish(kept["a"])  # data
        out.publish(kept["b"])  # clean
        out.publish(NAME([("a", msg.data), ("b", 0.0)])["b"])  # clean
        out.publish(NAME([("a", 0.0), ("b", msg.data)])["b"])  # data
    """,
    ("logging.getLogger",): """
        class Kept(logging.Handler):
            def emit(self, record):
                out.publish(record.getMessage())  # data
        NAME("a").addHandler(Kept())
        NAME("a.b").warning("%s", msg.data)
    """,
    ("logging.Handler.__init__",): """
        class Kept(logging.Handler):
            def __init__(self, level):
                NAME(self, level)
            def emit(self, record):
                out.publish(record.getMessage())  # data
        logging.getLogger("a").addHandler(Kept(logging.INFO))
        logging.getLogger("a").info("%s", msg.data)
    """,
    ("types.SimpleNamespace",): """
        kept = NAME(b=0.0, **{"a": msg.data})
        out.publish(kept.a)  # data
        out.publish(kept.b)  # clean
    """,
    ("defaultdict",): """
        kept = NAME(list, {"a": [0.0]})
        kept["b"].append(msg.data)
        out.publish(kept["b"][0])  # data
        out.publish(kept["a"][0])  # clean
        out.publish(kept["c"])  # clean
        out.publish(NAME(lambda: msg.data)["d"])  # data
    """,
    ("Counter",): """
        out.publish(NAME(msg.text)["a"])  # data
        out.publish(max(NAME(msg.text)))  # data
        out.publish(NAME("text")["a"])  # clean
    """,
    ("dict.fromkeys",): """
        out.publish(NAME(["a"], msg.data)["a"])  # data
        out.publish(NAME(["a"], 0.0)["a"])  # clean
        out.publish(max(NAME(msg.names, 0.0)))  # data
        out.publish(NAME(msg.names, 0.0)["a"])  # control
    """,
    ("namedtuple",): """
        Pair = NAME("Pair", "near far")
        pair = Pair(msg.data, far=0.0)
        out.publish(pair.near)  # data
        out.publish(pair[0])  # data
        out.publish(pair.far)  # clean
        out.publish(pair[1])  # clean
        Listed = NAME("Listed", ["far", "near"])
        out.publish(Listed(0.0, msg.data).near)  # data
        out.publish(Listed(0.0, msg.data).far)  # clean
    """,
    ("dataclasses.field",): """
        @dataclasses.dataclass
        class Pair:
            near: float
            far: float = NAME(default=0.0)
            all: list = NAME(default_factory=lambda: [msg.data])
            skipped: float = NAME(init=False, default=0.0)
            named: float = NAME(kw_only=True, default=0.0)
            last: float = 0.0
        pair = Pair(0.0, msg.data)
        out.publish(pair.near)  # clean
        out.publish(pair.far)  # data
        out.publish(Pair(msg.data).far)  # clean
        out.publish(pair.all[0])  # data
        out.publish(Pair(0.0, 0.0, [0.0], msg.data).last)  # data
        out.publish(Pair(0.0, 0.0, [0.0], msg.data).skipped)  # clean
        out.publish(Pair(0.0, 0.0, [0.0], msg.data).named)  # clean
        out.publish(Pair(0.0, named=msg.data).named)  # data
    """,
    ("dataclasses.replace", "copy.replace", "attr.evolve", "attrs.evolve"): """
        @dataclasses.dataclass
        class Pair:
            near: float
            far: float = 0.0
        old = Pair(0.0)
        new = NAME(old, near=msg.data)
        out.publish(new.near)  # data
        out.publish(new.far)  # clean
        out.publish(old.near)  # clean
        out.publish(NAME(Pair(0.0, msg.data), near=1.0).far)  # data
    """,
    ("dataclasses.asdict", "attr.asdict", "attrs.asdict"): """
        @dataclasses.dataclass
        class Pair:
            near: float
            far: float = 0.0
        out.publish(NAME(Pair(msg.data))["near"])  # data
        out.publish(NAME(Pair(msg.data))["far"])  # clean
    """,
    ("itertools.takewhile", "itertools.dropwhile", "itertools.filterfalse"): """
        out.publish(list(NAME(lambda x: x < 1.0, [msg.data, 2.0]))[0])  # data
        out.publish(list(NAME(lambda x: x < msg.data, [1.0, 2.0]))[0])  # control
        out.publish(list(NAME(lambda x: x < 1.0, [1.0, 2.0]))[0])  # clean
    """,
    ("itertools.compress",): """
        out.publish(list(NAME([msg.data, 2.0], [True, False]))[0])  # data
        out.publish(list(NAME([1.0, 2.0], [msg.data, False]))[0])  # control
        out.publish(list(NAME(msg.data))[0])  # data
    """,
    ("itertools.starmap",): """
        out.publish(list(NAME(lambda x, y: y, [(1.0, msg.data)]))[0])  # data
        out.publish(list(NAME(lambda x, y: x, [(1.0, msg.data)]))[0])  # clean
        out.publish(list(NAME(msg.data))[0])  # data
    """,
    ("property",): """
        class Motor:
            speed = NAME(lambda self: self.kept, lambda self, value: setattr(self, "kept", value))
        first, second = Motor(), Motor()
        first.speed, second.speed = msg.data, 1.0
        out.publish(first.speed)  # data
        out.publish(second.speed)  # clean
    """,
    ("dataclasses.fields", "attr.fields", "attrs.fields"): """
        @dataclasses.dataclass
        class Pair:
            near: float
            far: float = 0.0
        pair, kept = Pair(msg.data), {}
        for field in NAME(Pair):
            kept[field.name] = getattr(pair, field.name)
        out.publish(kept["near"])  # data
        out.publish(kept["far"])  # clean
        out.publish(len(NAME(Pair)))  # clean
    """,
    ("dataclasses.astuple", "attr.astuple", "attrs.astuple"): """
        @dataclasses.dataclass
        class Pair:
            near: float
            far: float = 0.0
        out.publish(NAME(Pair(msg.data))[0])  # data
        out.publish(NAME(Pair(msg.data))[1])  # clean
    """,
    ("type.__new__",): """
        class Meta(type):
            def __new__(mcs, name, bases, body):
                cls = NAME(mcs, name, bases, body)
                cls.near = msg.data
                return cls
        class Pair(metaclass=Meta):
            far = 0.0
        out.publish(Pair.near)  # data
        out.publish(Pair.far)  # clean
    """,
    ("object.__new__",): """
        class Pair:
            far = 0.0
        made, other = NAME(Pair), NAME(Pair)
        made.near = msg.data
        other.near = 0.0
        out.publish(made.near)  # data
        out.publish(made.far)  # clean
        out.publish(other.near)  # clean
    """,
    ("weakref.ref",): """
        class Pair: pass
        kept, other = Pair(), Pair()
        kept.near, other.near = msg.data, 0.0
        out.publish(NAME(kept)().near)  # data
        out.publish(NAME(other)().near)  # clean
    """,
    ("weakref.WeakMethod",): """
        class Pair:
            def near(self): return msg.data
            def far(self): return 0.0
        kept = Pair()
        out.publish(NAME(kept.near)()())  # data
        out.publish(NAME(kept.far)()())  # clean
    """,
    ("weakref.proxy",): """
        class Pair: pass
        kept = Pair()
        kept.near, kept.far = msg.data, 0.0
        out.publish(NAME(kept).near)  # data
        out.publish(NAME(kept).far)  # clean
    """,
    ("vars",): """
        class Pair: pass
        kept = Pair()
        NAME(kept)["near"] = msg.data
        kept.far = 0.0
        out.publish(kept.near)  # data
        out.publish(NAME(kept)["far"])  # clean
    """,
    ("typing.cast",): """
        kept = [msg.data, 0.0]
        out.publish(NAME(list, kept))  # clean
        out.publish(NAME(kept, None)[0])  # data
    """,
    ("type",): """
        class Pair:
            near, far = 0.0, 0.0
        Pair.near = msg.data
        kept = Pair()
        kept.far = msg.data
        out.publish(NAME(kept).near)  # data
        out.publish(NAME(kept).far)  # clean
        out.publish(NAME(msg.data))  # clean
    """,
    ("isinstance", "issubclass", "hasattr", "callable"): """
        if NAME(msg.data, "x"):
            out.publish(1.0)  # clean
        out.publish(NAME(msg.data, "x"))  # clean
    """,
    ("rospy.myargv", "rclpy.utilities.remove_ros_args"): """
        out.publish(NAME([0.0, msg.data])[1])  # data
        out.publish(NAME([0.0])[0])  # clean
    """,
    ("range", "xrange"): """
        for n in NAME(msg.count):
            out.publish(n)  # data
        for n in NAME(3):
            out.publish(n)  # clean
    """,
    ("len",): """
        kept = [msg.data]
        out.publish(NAME(kept))  # clean
        out.publish(NAME(msg.text))  # data
        other = [1.0]
        if msg.data > 0.0:
            kept.append(1.0)
            other.append(1.0)
        out.publish(NAME(kept))  # data
        out.publish(NAME(other))  # control
    """,
    ("bool",): """
        out.publish(NAME(msg.data))  # data
        out.publish(NAME(0.0))  # clean
        out.publish(NAME([msg.data]))  # clean
    """,
    ("any", "all"): """
        out.publish(NAME([0.0, msg.data]))  # data
        out.publish(NAME([0.0, 1.0]))  # clean
        out.publish(NAME(msg.items))  # data
    """,
    ("str",): """
        out.publish(NAME(msg.data))  # data
        out.publish(NAME(1.0))  # clean
    """,
    ("int",): """
        out.publish(NAME(msg.data))  # data
        out.publish(NAME("1"))  # clean
        kept = [0.0, msg.data]
        out.publish(kept[NAME(1.0)])  # data
    """,
    NAMES: """
        kept = {"near": msg.data, "far": 0.0}
        out.publish(kept[NAME("near")])  # data
        out.publish(kept[NAME("far")])  # clean
    """,
    PATHS: """
        kept = {"near/x": msg.data, "far/x": 0.0}
        out.publish(kept[NAME("near", "x")])  # data
        out.publish(kept[NAME("far", "x")])  # clean
        out.publish(NAME("far", msg.text))  # data
    """,
    ("enumerate",): """
        for number, value in NAME([0.0, msg.data]):
            out.publish(number)  # clean
            out.publish(value)  # data
        pairs = list(NAME([0.0, msg.data]))
        out.publish(pairs[1][1])  # data
        out.publish(pairs[0][1])  # clean
    """,
    (
        "heapq.heappush",
        "heapq.heappushpop",
        "heapq.heapreplace",
        "bisect.insort",
        "bisect.insort_left",
        "bisect.insort_right",
    ): """
        def near():
            out.publish(msg.data)  # data
        def far():
            out.publish(2.0)  # clean
        heap = []
        NAME(heap, (1, far))
        NAME(heap, (2, near))
        for _, one in heap:
            one()
        other = []
        NAME(other, 1.0)
        out.publish(other[0])  # clean
        kept = [0.0]
        NAME(kept, msg.data)
        out.publish(kept[0])  # data
    """,
    ("enum.auto",): """
        class Side(enum.Enum):
            LEFT = NAME()
            RIGHT = NAME()
        if Side.LEFT is Side.RIGHT:
            out.publish(msg.data)  # clean
        out.publish({Side.LEFT: msg.data, Side.RIGHT: 1.0}[Side.LEFT])  # data
        out.publish({Side.LEFT: msg.data, Side.RIGHT: 1.0}[Side.RIGHT])  # clean
    """,
    ("zip",): """
        pairs = list(NAME([0.0, msg.data], [0.0, 1.0]))
        out.publish(pairs[1][0])  # data
        out.publish(pairs[0][0])  # clean
        out.publish(pairs[1][1])  # clean
        near, far = NAME(*[(msg.data, 0.0), (msg.data, 1.0)])
        out.publish(near[0])  # data
        out.publish(far[0])  # clean
    """,
    ("map",): """
        kept = list(NAME(lambda v: v + 1.0, [0.0, msg.data]))
        out.publish(kept[1])  # data
        out.publish(kept[0])  # clean
        out.publish(list(NAME(lambda v: 1.0, msg.items))[0])  # clean
        out.publish(len(list(NAME(lambda v: 1.0, msg.items))))  # data
    """,
    ("heapq.heappop",): """
        out.publish(NAME([0.0, msg.data]))  # data
        out.publish(NAME([0.0, 1.0]))  # clean
    """,
    ("functools.reduce",): """
        out.publish(NAME(lambda total, x: total + x, [1.0, msg.data]))  # data
        out.publish(NAME(lambda total, x: total + 1.0, [1.0, msg.data], 0.0))  # clean
        out.publish(NAME(lambda total, x: total + x, msg.items, 0.0))  # data
        out.publish(NAME(lambda total, x: x, [msg.data, 1.0]))  # clean
        out.publish(NAME(getattr, ["part", "x"], msg))  # data
    """,
    ("filter",): """
        for value in NAME(lambda v: v > msg.data, [0.0, 1.0]):
            out.publish(value)  # control
        for value in NAME(None, [0.0, 1.0]):
            out.publish(value)  # clean
        for value in NAME(None, msg.items):
            out.publish(value)  # data
    """,
    ("min", "max"): """
        out.publish(NAME([0.0, msg.data]))  # data
        out.publish(NAME(0.0, msg.data))  # data
        out.publish(NAME(0.0, 1.0))  # clean
        out.publish(NAME([0.0, 1.0], key=lambda v: v * msg.data))  # control
    """,
    ("heapq.nlargest", "heapq.nsmallest"): """
        out.publish(NAME(1, [0.0, msg.data])[0])  # data
        out.publish(NAME(1, [0.0, 1.0])[0])  # clean
        out.publish(NAME(1, [0.0, 1.0], key=lambda v: v * msg.data)[0])  # control
        out.publish(len(NAME(int(msg.data), [0.0, 1.0])))  # data
    """,
    ("itertools.groupby",): """
        for key, group in NAME([0.0, 1.0], lambda v: v > msg.data):
            out.publish(key)  # data
            out.publish(list(group)[0])  # control
        for key, group in NAME([0.0, 1.0]):
            out.publish(key)  # clean
            out.publish(list(group)[0])  # clean
    """,
    ("next",): """
        out.publish(NAME(iter([msg.data])))  # data
        out.publish(NAME(iter([1.0])))  # clean
        out.publish(NAME(iter([1.0]), msg.data))  # data
        out.publish(NAME(iter([(1.0, msg.data)]))[0])  # clean
        out.publish(NAME(iter([(1.0, msg.data)]))[1])  # data
        if NAME(iter([[msg.data]]), None) is None:
            out.publish(1.0)  # clean
        def some():
            if msg.data > 0.0:
                yield 1.0
        out.publish(NAME(some(), 2.0))  # control
    """,
    ("asyncio.gather",): """
        async def near(): return msg.data
        async def far(): return 0.0
        kept = asyncio.run(NAME(near(), far()))
        out.publish(kept[0])  # data
        out.publish(kept[1])  # clean
        rest = [near(), far()]
        out.publish(asyncio.run(NAME(*rest))[0])  # data
    """,
    (*AWAITABLE, "asyncio.run_coroutine_threadsafe"): """
        async def near(): return [msg.data, 0.0]
        out.publish(NAME(near())[0])  # data
        out.publish(NAME(near())[1])  # clean
    """,
    ("getattr",): """
        class Pair:
            near, far = 0.0, 0.0
            def do_it(self): return self.near
        kept = Pair()
        kept.near = msg.data
        out.publish(NAME(kept, "near"))  # data
        out.publish(NAME(kept, "far"))  # clean
        out.publish(NAME(kept, "far", msg.data))  # data
        out.publish(NAME(kept, "do_" + rospy.get_name())())  # data
    """,
    ("operator.attrgetter", "operator.attrgetter.<made>"): """
        class Pair: pass
        kept = Pair()
        kept.near, kept.far, kept.inner = msg.data, 0.0, Pair()
        kept.inner.near = msg.data
        out.publish(NAME("near")(kept))  # data
        out.publish(NAME("far")(kept))  # clean
        out.publish(NAME("inner.near")(kept))  # data
        out.publish(NAME("near", "far")(kept)[0])  # data
        out.publish(NAME("near", "far")(kept)[1])  # clean
    """,
    ("operator.itemgetter", "operator.itemgetter.<made>"): """
        out.publish(NAME(0)([msg.data, 0.0]))  # data
        out.publish(NAME(1)([msg.data, 0.0]))  # clean
        out.publish(NAME(1, 0)([msg.data, 0.0])[1])  # data
        out.publish(NAME(1, 0)([msg.data, 0.0])[0])  # clean
    """,
    ("setattr",): """
        class Pair:
            near, far = 0.0, 0.0
        kept, other = Pair(), Pair()
        NAME(kept, "near", msg.data)
        NAME(other, msg.text, msg.data)
        out.publish(kept.near)  # data
        out.publish(kept.far)  # clean
        out.publish(other.unset)  # data
    """,
    ("object.__setattr__",): """
        class Plain: near, far = 0.0, 0.0
        kept = Plain()
        NAME(kept, "near", msg.data)
        out.publish(kept.near)  # data
        out.publish(kept.far)  # clean
    """,
    ("functools.wraps",): """
        def near(value): return value
        near.gain, near.limit = msg.data, 1.0
        @NAME(near)
        def far(value): return 2.0
        out.publish(far(1.0))  # clean
        out.publish(far.gain)  # data
        out.publish(far.limit)  # clean
    """,
    ("functools.update_wrapper",): """
        def near(value): return value
        near.gain, near.limit = msg.data, 1.0
        def far(value): return 2.0
        out.publish(NAME(far, near)(1.0))  # clean
        out.publish(far.gain)  # data
        out.publish(far.limit)  # clean
    """,
    ("functools.partialmethod",): """
        class Plain:
            def put(self, place, value): setattr(self, place, value)
            near, far = 0.0, 0.0
            put_near = NAME(put, "near")
        kept = Plain()
        kept.put_near(msg.data)
        out.publish(kept.near)  # data
        out.publish(kept.far)  # clean
    """,
    ("types.MethodType",): """
        class Plain: near, far = 0.0, 0.0
        def put(self, value): self.near = value
        kept = Plain()
        kept.put = NAME(put, kept)
        kept.put(msg.data)
        out.publish(kept.near)  # data
        out.publish(kept.far)  # clean
    """,
    ("dir",): """
        class Plain:
            def on_near(self): return msg.data
            def far(self): return 0.0
        kept = Plain()
        for name in NAME(kept):
            if name.startswith("on_"):
                out.publish(getattr(kept, name)())  # data
            else:
                out.publish(getattr(kept, name)())  # clean
    """,
    ("inspect.getmembers",): """
        class Plain:
            limit = 0.0
            def on_near(self): return msg.data
            def far(self): return 0.0
        kept = Plain()
        for name, method in NAME(kept, inspect.ismethod):
            if name.startswith("on_"):
                out.publish(method())  # data
            else:
                out.publish(method())  # clean
    """,
    ("multiprocessing.Pipe", "trio.open_memory_channel", "anyio.create_memory_object_stream"): """
        near, far = NAME()
        other, _ = NAME()
        near.send(msg.data)
        other.send(0.0)
        out.publish(far.recv())  # data
        out.publish(other.recv())  # clean
    """,
    IN_THREADS: """
        def run(value, other=1.0):
            return [value, other]
        async def main():
            kept = await NAME(run, msg.data)
            out.publish(kept[0])  # data
            out.publish(kept[1])  # clean
        asyncio.run(main())
    """,
    ("super",): """
        class Base:
            def near(self): return msg.data
            def far(self): return 0.0
        class Pair(Base):
            def near(self): return 0.0
            def far(self): return msg.data
            def both(self): return [NAME().near(), NAME().far()]
        out.publish(Pair().both()[0])  # data
        out.publish(Pair().both()[1])  # clean
    """,
    tuple(f"smach.{name}.add" for name in CONTAINERS): """
        class Near(smach.State):
            def execute(self, userdata):
                userdata.seen = msg.data
                userdata.other = 0.0
        class Far(smach.State):
            def execute(self, userdata):
                out.publish(userdata.kept)  # data
                out.publish(userdata.other)  # clean
        NAME("NEAR", Near(), remapping={"seen": "kept"})
        NAME("FAR", Far())
    """,
    ("smach.CBState", "smach.state.CBState"): """
        def near(userdata):
            userdata.seen = msg.data
        def far(userdata):
            out.publish(userdata.seen)  # data
            out.publish(userdata.other)  # clean
        NAME(near), NAME(cb=far)
    """,
    ("smach_ros.ConditionState",): """
        def near(userdata):
            userdata.seen = msg.data
            return True
        def far(userdata):
            out.publish(userdata.seen)  # data
            out.publish(userdata.other)  # clean
        NAME(near), NAME(cond_cb=far)
    """,
    ("smach_ros.SimpleActionState", "smach_ros.ServiceState"): """
        def near(userdata, result):
            userdata.seen = msg.data
        def far(userdata, goal):
            out.publish(userdata.seen)  # data
            out.publish(userdata.other)  # clean
        NAME("/a", A, result_cb=near), NAME("/b", B, goal_cb=far)
    """,
    ("smach.StateMachine.add_auto", "smach.Iterator.set_contained_state"): """
        class Near(smach.State):
            def execute(self, userdata):
                userdata.seen = msg.data
        class Far(smach.State):
            def execute(self, userdata):
                out.publish(userdata.seen)  # data
                out.publish(userdata.other)  # clean
        with smach.StateMachine(outcomes=["end"]):
            NAME("NEAR", Near(), ["done"])
            NAME("FAR", Far(), ["done"])
    """,
    tuple(name for name in MACHINES if not name.endswith("Concurrence")): """
        class Test(smach.State):
            def execute(self, userdata):
                return "yes" if msg.data > 1.0 else "no"
        class Far(smach.State):
            def execute(self, userdata):
                out.publish(1.0)  # control
        with NAME(["no"], "done"):
            smach.StateMachine.add("TEST", Test(), {"yes": "FAR", "no": "no"})
            smach.StateMachine.add("FAR", Far())
    """,
    tuple(name for name in MACHINES if name.endswith("Concurrence")): """
        class Test(smach.State):
            def execute(self, userdata):
                return "yes" if msg.data > 1.0 else "no"
        class Far(smach.State):
            def execute(self, userdata):
                out.publish(1.0)  # clean
        with NAME(["no"], "no"):
            smach.StateMachine.add("TEST", Test(), {"yes": "FAR", "no": "no"})
            smach.StateMachine.add("FAR", Far())
    """,
    tuple(name for name in COMPOSITES if not name.endswith("Parallel")): in_tree(
        "control",
        """
        NAME("root", False, children=[Test(), Far()])
    """,
    ),
    tuple(name for name in COMPOSITES if name.endswith("Parallel")): in_tree(
        "clean",
        """
        NAME("root", children=[Test(), Far()])
    """,
    ),
    DECORATORS: in_tree(
        "control",
        """
        inner = py_trees.composites.Parallel("inner", children=[NAME("t", child=Far())])
        py_trees.composites.Sequence("root", False, children=[Test(), inner])
    """,
    ),
    CONSTANTS: in_tree(
        "clean",
        """
        py_trees.composites.Sequence("root", False, children=[NAME("one"), Far()])
    """,
    ),
    CHECKS: in_tree(
        "control",
        """
        py_trees.blackboard.Blackboard.set("level", msg.data)
        py_trees.composites.Sequence("root", False, children=[NAME("one", "level"), Far()])
    """,
    ),
    (COMPARISON,): in_tree(
        "control",
        """
        py_trees.blackboard.Blackboard.set("level", msg.data)
        check = py_trees.behaviours.CheckBlackboardVariableValue("check", NAME("level", 1.0, min))
        py_trees.composites.Sequence("root", False, children=[check, Far()])
    """,
    ),
    CLIENTS: """
        near, far = NAME("near", "near"), NAME(name="far", namespace="far")
        near.level, far.level = msg.data, 1.0
        out.publish(NAME("other", "near").level)  # data
        out.publish(NAME("other", "far").level)  # clean
    """,
    GETTERS: """
        py_trees.blackboard.Client(name="near").level = msg.data
        out.publish(NAME("level"))  # data
        out.publish(NAME("other"))  # clean
    """,
    SETTERS: """
        NAME("level", msg.data)
        out.publish(py_trees.blackboard.Client(name="near").level)  # data
        out.publish(py_trees.blackboard.Client(name="near").other)  # clean
    """,
}
COVERED = [(name, body) for names, body in CASES.items() for name in names]


def test_each_function_with_a_model_has_a_test():
    names = [name for name, _ in COVERED]
    assert sorted(names) == sorted(BUILTIN), "add a body for each new model to CASES"


@pytest.mark.parametrize(("name", "body"), COVERED, ids=[name for name, _ in COVERED])
def test_modelled_function_returns_data_of_its_arguments(name, body):
    path = WHERE.get(name, name)
    modules = {path.rpartition(".")[0]} - {
        "",
        "dict",
        "object",
        "type",
        *(f"smach.{name}" for name in (*CONTAINERS, "Iterator")),
    }
    head = "\n".join(
        f"import {module}" for module in sorted({*modules, "asyncio", "dataclasses", "py_trees", "smach"})
    )
    assert differing(in_callback(body.replace("NAME", path), head)) == {}
