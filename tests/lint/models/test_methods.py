"""Each method with a model, and each function that changes an argument, has an exact test here."""

from __future__ import annotations

import pytest

from tarl_lint import catalog
from tarl_lint.models.futures import READERS
from tests.lint.models.marked import differing, in_callback

# method(s) → the body of a callback, in which NAME is the method
READ: dict[tuple[str, ...], str] = {
    ("get",): """
        kept = {"a": msg.data, "b": 0.0}
        out.publish(kept.NAME("a"))  # data
        out.publish(kept.NAME("b"))  # clean
        out.publish(kept.NAME("c", msg.data))  # data
        out.publish(kept.NAME("b", 1.0))  # clean
    """,
    ("__getitem__",): """
        kept = [msg.data, 0.0]
        out.publish(kept.NAME(0))  # data
        out.publish(kept.NAME(1))  # clean
    """,
    ("__get__",): """
        class Kept:
            pass
        def held(self):
            return self.value
        one, two = Kept(), Kept()
        one.value, two.value = msg.data, 0.0
        out.publish(held.NAME(one)())  # data
        out.publish(held.NAME(two, Kept)())  # clean
    """,
    ("_make",): """
        Pair = collections.namedtuple("Pair", "a b")
        out.publish(Pair.NAME([msg.data, 0.0]).a)  # data
        out.publish(Pair.NAME([msg.data, 0.0]).b)  # clean
        out.publish(Pair(1.0, 2.0).NAME([0.0, msg.data]).b)  # data
        out.publish(Pair.NAME(x for x in msg.data).b)  # data
        out.publish(Pair.NAME(x for x in range(2)).b)  # clean
    """,
    ("__setitem__",): """
        kept = [0.0, 0.0]
        kept.NAME(0, msg.data)
        out.publish(kept[0])  # data
        out.publish(kept[1])  # clean
    """,
    ("pop",): """
        kept = {"a": msg.data, "b": 0.0}
        out.publish(kept.NAME("b"))  # clean
        out.publish(kept.NAME("a"))  # data
        full = [1.0, 2.0]
        if msg.data > 0.0:
            full.NAME(0)
        out.publish(len(full))  # control
        out.publish(full[0])  # control
        others = [1.0, 2.0, msg.data]
        others.NAME(0)
        out.publish(others[0])  # clean
        out.publish(others[1])  # data
    """,
    ("popleft", "get_nowait"): """
        kept, other = collections.deque([msg.data]), collections.deque([0.0])
        out.publish(kept.NAME())  # data
        out.publish(other.NAME())  # clean
        if msg.data > 0.0:
            other.NAME()
        out.publish(len(other))  # control
    """,
    ("popitem",): """
        kept, other = {"a": msg.data}, {"a": 0.0}
        out.publish(kept.NAME())  # data
        out.publish(other.NAME())  # clean
    """,
    ("reverse",): """
        kept, other = [0.0, msg.data], [0.0, 1.0]
        kept.NAME()
        out.publish(kept[0])  # data
        out.publish(kept[1])  # clean
        out.publish(len(kept))  # clean
        if msg.data > 0.0:
            other.NAME()
        out.publish(other[0])  # control
    """,
    ("difference_update", "intersection_update"): """
        kept = {0.0, 1.0}
        if msg.data > 0.0:
            kept.NAME({0.0})
        out.publish(len(kept))  # control
        out.publish(max(kept))  # control
        other = {0.0, 1.0}
        other.NAME({0.0})
        out.publish(len(other))  # clean
        third = {0.0, 1.0}
        third.NAME(msg.items)
        out.publish(len(third))  # control
    """,
    ("remove", "discard"): """
        kept = [0.0, 1.0]
        if msg.data > 0.0:
            kept.NAME(0.0)
        out.publish(len(kept))  # control
        out.publish(kept[0])  # control
        other = [0.0, 1.0]
        other.NAME(0.0)
        out.publish(len(other))  # clean
    """,
    ("next", "__next__"): """
        kept, other = iter([msg.data]), iter([0.0])
        out.publish(kept.NAME())  # data
        out.publish(other.NAME())  # clean
    """,
    ("qsize", "empty", "full"): """
        kept, other = queue.Queue(), queue.Queue()
        other.put(0.0)
        if msg.data > 0.0:
            kept.put(1.0)
        out.publish(kept.NAME())  # control
        out.publish(other.NAME())  # clean
    """,
    ("values", "itervalues"): """
        out.publish(list({"a": msg.data}.NAME())[0])  # data
        out.publish(list({"a": 0.0}.NAME())[0])  # clean
        out.publish(list({msg.name: 0.0}.NAME())[0])  # clean
    """,
    ("keys", "iterkeys"): """
        out.publish(list({"a": msg.data}.NAME())[0])  # clean
        out.publish(list({msg.name: 0.0}.NAME())[0])  # data
    """,
    ("items", "iteritems"): """
        for key, value in {"a": msg.data}.NAME():
            out.publish(key)  # clean
            out.publish(value)  # data
        for key, value in {msg.name: 0.0}.NAME():
            out.publish(key)  # data
            out.publish(value)  # clean
    """,
    ("copy",): """
        kept = [msg.data, 0.0]
        made = kept.NAME()
        kept[1] = msg.data
        out.publish(made[0])  # data
        out.publish(made[1])  # clean
    """,
    ("_replace",): """
        Pair = collections.namedtuple("Pair", "near far")
        made = Pair(0.0, 0.0).NAME(near=msg.data)
        out.publish(made.near)  # data
        out.publish(made[0])  # data
        out.publish(made.far)  # clean
        out.publish(made[1])  # clean
    """,
    ("_asdict",): """
        Pair = collections.namedtuple("Pair", "near far")
        made = Pair(msg.data, 0.0).NAME()
        out.publish(made["near"])  # data
        out.publish(made["far"])  # clean
    """,
    ("result", "set_result"): """
        kept, other, decided = asyncio.Future(), asyncio.Future(), asyncio.Future()
        kept.set_result(msg.data)
        other.set_result(result=0.0)
        if msg.data > 0.0:
            decided.set_result(1.0)
        out.publish(kept.result())  # data
        out.publish(other.result())  # clean
        out.publish(asyncio.Future(msg.data).result())  # data
    """,
    ("submit",): """
        pool = concurrent.futures.ThreadPoolExecutor()
        out.publish(pool.NAME(lambda a, b: a, msg.data, 0.0).result())  # data
        out.publish(pool.NAME(lambda a, b: b, msg.data, 0.0).result())  # clean
    """,
    ("run_in_executor",): """
        loop = asyncio.get_event_loop()
        out.publish(loop.NAME(None, lambda a, b: a, msg.data, 0.0).result())  # data
        out.publish(loop.NAME(None, lambda a, b: b, msg.data, 0.0).result())  # clean
    """,
    ("enter_context", "enter_async_context"): """
        @contextlib.contextmanager
        def first_of(value, other):
            yield value

        stack = contextlib.ExitStack()
        out.publish(stack.NAME(first_of(msg.data, 0.0)))  # data
        out.publish(stack.NAME(first_of(0.0, msg.data)))  # clean
    """,
    ("done",): """
        kept, decided = asyncio.Future(), asyncio.Future()
        kept.set_result(msg.data)
        if msg.data > 0.0:
            decided.set_result(1.0)
        out.publish(kept.NAME())  # clean
        out.publish(decided.NAME())  # control
        out.publish(asyncio.Future(msg.data).NAME())  # data
    """,
}
CHANGED: dict[tuple[str, ...], str] = {
    ("add",): """
        kept, other = set(), set()
        kept.NAME(msg.data)
        other.NAME(0.0)
        out.publish(kept.pop())  # data
        out.publish(other.pop())  # clean
        out.publish(len(kept))  # data
        out.publish(len(other))  # clean
    """,
    ("append", "put", "put_nowait", "send_nowait", "push", "push_back", "appendleft"): """
        kept, other = [], []
        kept.NAME(msg.data)
        other.NAME(0.0)
        out.publish(kept.pop())  # data
        out.publish(other.pop())  # clean
        out.publish(len(kept))  # clean
    """,
    ("insert",): """
        kept, other, moved = [0.0], [0.0], [msg.data, 0.0]
        moved.NAME(0, 1.0)
        out.publish(moved[1])  # data
        kept.NAME(0, msg.data)
        other.NAME(msg.data, 1.0)
        out.publish(kept.pop())  # data
        out.publish(other.pop())  # clean
    """,
    ("writerow",): """
        kept, other = io.StringIO(), io.StringIO()
        csv.writer(kept).NAME([msg.data])
        csv.writer(other).NAME([0.0])
        out.publish(kept.getvalue())  # data
        out.publish(other.getvalue())  # clean
    """,
    ("writerows",): """
        kept, other = io.StringIO(), io.StringIO()
        csv.writer(kept).NAME([[msg.data], [0.0]])
        csv.writer(other).NAME([[0.0]])
        out.publish(kept.getvalue())  # data
        out.publish(other.getvalue())  # clean
    """,
    ("extend", "extendleft"): """
        kept, other = [0.0], [0.0]
        kept.NAME([msg.data])
        other.NAME([0.0])
        out.publish(kept.pop())  # data
        out.publish(other.pop())  # clean
        out.publish(len(kept))  # clean
        kept.NAME(msg.items)
        out.publish(len(kept))  # data
    """,
    ("update",): """
        kept, seen, near = {"a": 0.0}, {0.0}, {"a": 0.0}
        kept.NAME({"b": msg.data}, c=msg.data)
        seen.NAME([msg.data])
        near.NAME([("b", msg.data), ("c", 0.0)])
        out.publish(kept["b"])  # data
        out.publish(kept["c"])  # data
        out.publish(kept["a"])  # clean
        out.publish(seen.pop())  # data
        out.publish(near["b"])  # data
        out.publish(near["c"])  # clean
        class Pair:
            far = 0.0
        pair = Pair()
        vars(pair).NAME(near=msg.data)
        out.publish(pair.near)  # data
        out.publish(pair.far)  # clean
    """,
    ("setdefault",): """
        kept = {"a": 0.0}
        kept.NAME("b", msg.data)
        out.publish(kept["b"])  # data
        out.publish(kept["a"])  # clean
        out.publish(kept.NAME("c", 0.0))  # clean
        other = {}
        other.NAME(msg.name, msg.data)
        out.publish(other["d"])  # data
    """,
    ("sort",): """
        kept = [0.0, 1.0]
        kept.NAME()
        out.publish(kept[0])  # clean
        kept.NAME(key=lambda v: v * msg.data)
        out.publish(kept[0])  # control
    """,
    ("clear",): """
        kept = [msg.data]
        kept.NAME()
        kept.append(0.0)
        out.publish(kept[0])  # clean
        other = [0.0]
        if msg.data > 0.0:
            other.NAME()
        out.publish(len(other))  # control
    """,
    ("set",): """
        kept, other = threading.Event(), threading.Event()
        other.NAME()
        if msg.data > 0.0:
            kept.NAME()
        if kept.is_set():
            out.publish(1.0)  # control
        if other.is_set():
            out.publish(1.0)  # clean
    """,
    ("fill",): """
        kept = numpy.zeros(3)
        kept.NAME(msg.data)
        out.publish(kept[0])  # data
        out.publish(numpy.zeros(3)[0])  # clean
    """,
    ("itemset",): """
        kept = numpy.zeros(3)
        kept.NAME(0, msg.data)
        out.publish(kept[0])  # data
        out.publish(numpy.zeros(3)[0])  # clean
    """,
    ("write", "send"): """
        port, text, other = serial.Serial("a"), io.StringIO(), io.StringIO()
        port.NAME(msg.data)
        text.NAME(msg.data)
        other.NAME("x")
        out.publish(port.read())  # clean
        out.publish(text.read())  # data
        out.publish(other.read())  # clean
    """,
}
FUNCTIONS: dict[tuple[str, ...], str] = {
    (
        *("cv2.circle", "cv2.line", "cv2.arrowedLine", "cv2.ellipse", "cv2.fillPoly", "cv2.polylines"),
        *("cv2.drawContours", "cv2.putText", "cv2.rectangle"),
        *("numpy.copyto", "numpy.put", "numpy.place", "numpy.putmask", "numpy.fill_diagonal"),
    ): """
        kept, other = numpy.zeros(3), numpy.zeros(3)
        NAME(kept, msg.data)
        NAME(other, 1.0)
        out.publish(kept[0])  # data
        out.publish(other[0])  # clean
    """,
    catalog.FILLS_MESSAGES: """
        kept, other = Made(), Made()
        NAME(kept, [msg.data])
        NAME(other, [1.0])
        out.publish(kept)  # data
        out.publish(other)  # clean
    """,
    ("random.shuffle",): """
        kept = [0.0, msg.data]
        NAME(kept)
        out.publish(kept[0])  # data
        other = [0.0, 1.0]
        NAME(other)
        out.publish(other[0])  # clean
    """,
    ("struct.pack_into",): """
        kept, other = bytearray(8), bytearray(8)
        NAME("d", kept, 0, msg.data)
        NAME("d", other, 0, 1.0)
        out.publish(kept[0])  # data
        out.publish(other[0])  # clean
    """,
}
WRITING: dict[tuple[str, ...], str] = {
    ("pack_into",): """
        kept, other = bytearray(8), bytearray(8)
        struct.Struct("d").NAME(kept, 0, msg.data)
        struct.Struct("d").NAME(other, 0, 1.0)
        out.publish(kept[0])  # data
        out.publish(other[0])  # clean
    """,
    ("readinto", "recv_into"): """
        kept, other = bytearray(8), bytearray(8)
        serial.Serial(msg.name).NAME(kept)
        serial.Serial("port").NAME(other)
        out.publish(kept[0])  # data
        out.publish(other[0])  # clean
    """,
}
HEAD = "\n".join(
    f"import {name}"
    for name in (
        *("asyncio", "bisect", "collections", "concurrent.futures", "csv", "cv2", "genpy.message", "heapq"),
        *("io", "numpy", "queue", "random", "roslib.message", "rosidl_runtime_py.set_message", "serial"),
        *("struct", "threading"),
    )
)
HEAD += "\nfrom shop.msg import Made"
TABLES = {"read": READ, "changed": CHANGED, "functions": FUNCTIONS, "writing": WRITING}
COVERED = [(name, body) for table in TABLES.values() for names, body in table.items() for name in names]


@pytest.mark.parametrize(
    ("table", "models"),
    [
        ("read", READERS.keys()),
        ("changed", catalog.MUTATORS),
        ("functions", catalog.ARGUMENT_WRITERS.keys() - {"setattr"}),  # has a separate model
        ("writing", catalog.METHODS_WRITING.keys()),
    ],
)
def test_each_model_has_a_test(table, models):
    assert sorted(name for names in TABLES[table] for name in names) == sorted(models)


@pytest.mark.parametrize(("name", "body"), COVERED, ids=[name for name, _ in COVERED])
def test_a_method_reads_back_only_stored_values(name, body):
    assert differing(in_callback(body.replace("NAME", name), HEAD)) == {}
