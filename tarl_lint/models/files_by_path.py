"""Files with a known path: what a program writes into a file comes out where it reads the same path.

A file is a stream in memory that all calls of `open` with its path share. Devices are left out, since they do not
return what was written.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, join_all, pointer
from tarl_lint.models import containers

OPENING: Final = ("open", "io.open", "codecs.open")
PATHS: Final = ("pathlib.Path", "pathlib.PosixPath", "pathlib.PurePath")
# functions that return another spelling of a path
RESOLVING: Final = tuple(
    f"os.path.{name}" for name in ("abspath", "expanduser", "expandvars", "normpath", "realpath")
)
# functions that write the given argument into a file, whose path is the first argument
WRITING: Final = {"numpy.save": 1, "numpy.savetxt": 1, "cv2.imwrite": 1}
READING: Final = ("numpy.load", "numpy.loadtxt", "numpy.genfromtxt", "cv2.imread")
METHODS: Final = ("open", "read_text", "read_bytes", "write_text", "write_bytes")  # of a path
NO_FILES: Final = ("/dev/", "/sys/", "/proc/")  # beginnings of the paths of devices
FILE: Final = containers.IN_MEMORY + "file"  # name of the object that represents a file
KNOWN: Final = ("name", "mode", "closed", "encoding")  # attributes without data of the file


def opened(ctx: Interpreter, it: Invocation) -> Value:
    """Return the file that `open` opens; a new object if its path is not known."""
    given = it.arguments[0]
    path = given[0] if given else it.arguments[1].get("file", BOTTOM)
    found = _file(ctx, path)
    if found is None:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    return pointer(found, ctx.use(path))


def path_of(ctx: Interpreter, it: Invocation) -> Value:
    """Return `Path(text)`, or another spelling of a path: a known text stands for its path."""
    given = it.arguments[0]
    if len(given) == 1 and not given[0].pts and given[0].names():
        return given[0]
    return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)


def written(ctx: Interpreter, it: Invocation) -> Value:
    """Write an argument into a file, and return what the function returns."""
    place, given = WRITING[it.name], it.arguments[0]
    found = _file(ctx, given[0]) if len(given) > place else None
    if found is not None:
        _write(ctx, found, given[place], it)
    return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)


def read(ctx: Interpreter, it: Invocation) -> Value:
    """Return what a function reads from a file."""
    found = ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    held = _file(ctx, it.arguments[0][0]) if it.arguments[0] else None
    if held is not None and (content := ctx.use(heap.read_any(ctx, held))):
        for obj in found.objects:
            updates.add_element(ctx, pointer(obj), Value(content))
    return found


def call_path(ctx: Interpreter, it: Invocation) -> Value | None:
    """Call a method of a known path that opens, reads or writes the file; None for other methods and objects."""
    found = _file(ctx, it.base) if it.name in METHODS else None
    if found is None:
        return None
    if it.name == "open":
        return pointer(found, it.base.deps)
    if it.name.startswith("read"):
        return Value(it.base.deps | ctx.use(heap.read_any(ctx, found)))
    _write(ctx, found, join_all(it.arguments[0]), it)
    return UNKNOWN


def _write(ctx: Interpreter, file: Obj, value: Value, it: Invocation) -> None:
    containers.insert_elements(ctx, pointer(file), [Value(ctx.use(value))], it.frame, it.call)


def _file(ctx: Interpreter, path: Value) -> Obj | None:
    """Return the object of a file in the current program; None if the path is not a single known text."""
    names = path.names() if not path.pts else ()
    if len(names) != 1 or names[0].startswith(NO_FILES):
        return None
    root = ctx.store.root
    made = recency.intern(ctx, "lib", ("file", root.program, names[0]), FILE)
    if root.once and not ctx.store.waited and not ctx.store.stored((made, ANY)):
        # at its start, a program finds only what an earlier run has left in the file
        ctx.store.put((made, ANY), BOTTOM)
    for name in KNOWN:
        if ctx.store.get((made, name)) is None:
            ctx.store.put((made, name), Value(path.deps, consts=path.consts if name == "name" else None))
    return made
