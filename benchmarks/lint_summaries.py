"""Measure what function summaries could save: `python benchmarks/lint_summaries.py TREE [TREE ...]`.

For each tree, the script prints the CPU seconds of the interpretation, and how many of these are spent in function
bodies (without nested calls), separately for the first and later runs of a function in a call context. It also prints
how many of them summaries would save if applying a summary cost nothing. A summary is assumed to be valid for all runs
of a function with the same key. There are three variants of the key:

- *arguments*: kinds and classes of the arguments' objects, their constants, and whether they carry data. The result
  also depends on what the function reads elsewhere, so this is an upper limit of what a correct summary can save.
- *reads*: also the same facts about every value that the run reads before writing it, by kind of object and name of
  field.
- *aliases*: also which of these objects are identical (identified by the paths to them), and which statements no source
  has reached yet.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import time
from collections import defaultdict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from unittest import mock

from tarl_lint.cli import main as lint
from tarl_lint.interpret import call_replay
from tarl_lint.interpret.call_replay import Mode, Run
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.memory.frames import Frame, Origin
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import Key, Obj, Value

NAMED = ("module", "class", "ext")  # kinds of objects that are the same in all call contexts
KEYS = ("arguments", "reads", "aliases")


@dataclass
class Names:
    """Gives each object a name that is the same in every call context."""

    frame: Frame
    known: dict[Obj, Hashable] = field(default_factory=dict)

    def name(self, obj: Obj) -> Hashable:
        """Return an object's name, from its definition, the object that contains it, or its order of appearance."""
        if obj not in self.known:
            self.known[obj] = self._new(obj)
        return self.known[obj]

    def _new(self, obj: Obj) -> Hashable:
        if isinstance(obj, Frame):
            return "frame", obj is self.frame or id(obj)
        if obj.kind in NAMED:
            return obj.kind, str(obj.key)
        if obj.kind == "closure" and isinstance(obj.info, tuple):
            return "closure", obj.info[0].module, obj.info[0].pos
        if obj.kind in ("bound", "method") and isinstance(obj.info, tuple):
            return obj.kind, obj.name, tuple(self.name(part) for part in obj.info if isinstance(part, Obj))
        if obj.parent is not None and obj.parent in self.known:
            return "part", self.known[obj.parent], obj.name
        return kind_of(obj), obj.many, obj.laden, len(self.known)

    def value(self, value: Value) -> Hashable:
        """Return what is the same in all call contexts: whether the value carries data, its objects, its constants."""
        found = sorted(value.pts, key=lambda o: (o not in self.known, o.kind, o.name, o.number))
        return bool(value.deps), tuple(self.name(o) for o in found), value.consts


def kind_of(obj: Obj) -> Hashable:
    """Return an object's kind and class."""
    if obj.kind in NAMED:
        return obj.kind, str(obj.key)
    return obj.kind, obj.info.name if isinstance(obj.info, Obj) else ""


def kinds(value: Value) -> Hashable:
    """Return whether a value carries data, the kinds of its objects, and its constants."""
    return bool(value.deps), frozenset(map(kind_of, value.pts)), value.consts


def arguments_of(passed: Arguments, form: Callable[[Value], Hashable]) -> Hashable:
    """Return the arguments of a call, each converted by `form`."""
    return tuple(map(form, passed[0])), tuple((name, form(passed[1][name])) for name in sorted(passed[1]))


def read_kinds(run: Run) -> Hashable:
    """Return the kinds of all values that a run reads."""
    return frozenset((kind_of(k[0]), k[1], kinds(v)) for k, v in run.found.items() if v is not None)


def read_objects(ctx: Interpreter, frame: Frame, run: Run) -> Hashable:
    """Return the values that a run reads, with aliases, and the statements that no source has reached yet."""
    names = Names(frame)
    found: list[Hashable] = [arguments_of(run.passed, names.value)]
    left = {key: value for key, value in run.found.items() if value is not None}
    while ready := [k for k in left if _nameable(names, k)]:
        ready.sort(key=lambda k: (repr(names.name(k[0])), k[1]))
        found += [(names.name(k[0]), k[1], names.value(left.pop(k))) for k in ready]
    places = [ctx.graph.places[node] for node in run.reads.unreached]
    unreached = ((p.frame.function.pos, p.statement.pos if p.statement else None, p.role) for p in places)
    return tuple(found), frozenset((k[0].kind, k[1]) for k in left), frozenset(unreached)


def _nameable(names: Names, key: Key) -> bool:
    return key[0] in names.known or isinstance(key[0], Frame) or key[0].kind in (*NAMED, "closure")


@dataclass
class Meter:
    """Measures the time spent in function bodies, and how much of it a summary would save."""

    total: float = 0.0  # duration of the interpretation (s)
    overhead: float = 0.0  # time spent on measuring (s)
    spent: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    nested: list[float] = field(default_factory=list)
    contexts: set[Frame] = field(default_factory=set)
    seen: set[Hashable] = field(default_factory=set)

    def executed(
        self,
        ctx: Interpreter,
        frame: Frame,
        passed: Arguments,
        parts: tuple[Origin, ...],
        mode: Mode,
        execute: Callable[[], Delta],
    ) -> Run:
        """Execute a call instead of `replay._executed`, and count it."""
        start, overhead = time.process_time(), self.overhead
        self.nested.append(0.0)
        run = EXECUTED(ctx, frame, passed, parts, mode, execute)
        took = time.process_time() - start - (self.overhead - overhead)
        own = took - self.nested.pop()
        if self.nested:
            self.nested[-1] += took
        start = time.process_time()
        self._count(own, ctx, frame, run)
        self.overhead += time.process_time() - start
        return run

    def _count(self, own: float, ctx: Interpreter, frame: Frame, run: Run) -> None:
        when = "again" if frame in self.contexts else "first"
        self.contexts.add(frame)
        self.spent[when] += own
        function = (frame.function.module, frame.function.pos)
        forms = (arguments_of(run.passed, kinds), read_kinds(run), read_objects(ctx, frame, run))
        for name, form in zip(KEYS, forms, strict=True):
            key = (name, function, arguments_of(run.passed, kinds), form)
            if key in self.seen:
                self.spent[f"{name} {when}"] += own
            self.seen.add(key)

    def link(self, machine: Linker) -> None:
        """Interpret the modules instead of `Linker.link`."""
        start, overhead = time.process_time(), self.overhead
        LINK(machine)
        self.total += time.process_time() - start - (self.overhead - overhead)
        self.seen.clear()
        self.contexts.clear()


EXECUTED = call_replay._executed
LINK = Linker.link


def measure(tree: str) -> Meter:
    """Lint a tree and return what was measured."""
    meter = Meter()
    with (
        mock.patch.object(call_replay, "_executed", meter.executed),
        mock.patch.object(Linker, "link", lambda machine: meter.link(machine)),
        contextlib.redirect_stdout(io.TextIOWrapper(io.BytesIO())),
    ):
        lint(["--no-cache", "--jobs", "1", "--exit-zero", "--format", "concise", tree])
    return meter


def main() -> None:
    """Print a row for each tree."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("trees", nargs="+")
    arguments = parser.parse_args()
    print("| tree | interpretation | first runs | other runs |", " | ".join(f"saved: {k}" for k in KEYS), "|")
    for tree in arguments.trees:
        meter = measure(tree)
        saved = [meter.spent[f"{k} first"] + meter.spent[f"{k} again"] for k in KEYS]
        figures = [meter.total, meter.spent["first"], meter.spent["again"], *saved]
        print(f"| {tree} |", " | ".join(f"{f:.2f}" for f in figures), "|", flush=True)


if __name__ == "__main__":
    main()
