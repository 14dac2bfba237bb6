"""Work that is not an executed statement counts for the limits, and the files of a program share one budget."""

from __future__ import annotations

import ast

from tarl_lint.interpret.budget import MAX_STATEMENTS, VALUES_HANDLED
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.state import Work
from tarl_lint.memory import object_contents
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config

# objects that all point to each other; each of `steps` statements passes one of them on and stores a constant in it
RING = """
import rospy
from std_msgs.msg import Float64

class Part:
    def __init__(self, name):
        self.name, self.before, self.after, self.data, self.count = name, None, None, None, 0

def touch(part, count):
    part.count = count
    return part

def on(msg):
    parts[0].data = msg.data
{steps}
    pub.publish(last.after.data)

{parts}
parts = [{names}]
for a in range({size}):
    parts[a].after = parts[a - 1]
    parts[a - 1].before = parts[a]
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, on)
rospy.spin()
"""


def ring(size: int, steps: int) -> dict[str, str]:
    return {
        "node.py": RING.format(
            steps="\n".join(f"    last = touch(part_{n % size}, {n})" for n in range(steps)),
            parts="\n".join(f"part_{n} = Part({n})" for n in range(size)),
            names=", ".join(f"part_{n}" for n in range(size)),
            size=size,
        )
    }


def linked(files: dict[str, str]) -> Linker:
    modules = [
        Module(
            path, path.removesuffix(".py").replace("/", ".").removesuffix(".__init__"), text, ast.parse(text)
        )
        for path, text in files.items()
    ]
    machine = Linker(modules, Config(), thorough=False)
    machine.link()
    return machine


def reads_of_objects(monkeypatch, files: dict[str, str]) -> int:
    """Return how often the contents of an object are read."""
    count = 0
    real = object_contents._read

    def counted(*arguments):
        nonlocal count
        count += 1
        return real(*arguments)

    monkeypatch.setattr(object_contents, "_read", counted)
    linked(files)
    monkeypatch.setattr(object_contents, "_read", real)
    return count


def test_cyclic_objects_are_read_again_only_after_a_store(monkeypatch):
    """A read of each object after each store would double with the size of the ring."""
    small, large = (reads_of_objects(monkeypatch, ring(size, 120)) for size in (8, 16))
    assert 0 < large < 1.5 * small


def test_object_reads_grow_linearly_with_statements(monkeypatch):
    few, many = (reads_of_objects(monkeypatch, ring(8, steps)) for steps in (60, 120))
    assert 0 < many < 2.2 * few


def test_searches_for_data_are_charged_to_the_budget():
    machine = linked(ring(16, 60))
    (charged,) = machine.work.totals.values()
    assert machine.work.handled > 0
    assert charged < MAX_STATEMENTS
    work = Work(spent=10, saved=4, handled=3 * VALUES_HANDLED)
    assert (work.executed, work.charged) == (6, 9)


SHARED = {
    "pkg/__init__.py": "",
    "pkg/inner.py": "import rospy\ndef on_a(msg):\n    pub.publish(msg)\n"
    "pub = rospy.Publisher('out', Float64)\nrospy.Subscriber('in', Float64, on_a)\n",
}


def test_entry_points_of_an_imported_file_use_the_program_budget():
    machine = linked({**SHARED, "run.py": "import rospy\nfrom pkg.inner import on_a\nrospy.spin()\n"})
    assert set(machine.work.totals) <= {"run.py", "pkg/__init__.py", "pkg/inner.py"}
    assert machine.work.charged_to("pkg/inner.py") == "run.py"
    assert machine.work.charged_to("run.py") == "run.py"


def test_imported_program_has_its_own_budget():
    inner = SHARED["pkg/inner.py"] + "if __name__ == '__main__':\n    rospy.spin()\n"
    machine = linked({"inner.py": inner, "test_inner.py": "from inner import on_a\n"})
    assert machine.work.charged_to("inner.py") == "inner.py"


def test_first_importing_program_is_charged_even_in_a_cycle():
    work = Work(importers={"a": {"b": False, "init": True}, "b": {"a": False, "run": False}})
    assert [work.charged_to(path) for path in ("a", "b", "run", "init")] == ["run", "run", "run", "init"]
    assert Work(importers={"a": {"b": False}, "b": {"a": False}}).charged_to("a") == "a"
