"""What variables contain: constants with their origins, and unchanged fields of messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from tarl_lint.interpret import fallbacks
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, reachable_data
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, NONE, Obj, Value, join

MAX_VARIABLES = 400


@dataclass(frozen=True, slots=True)
class Origin:
    """A constant and its place in the source; the value is None if only known at run time (a parameter)."""

    value: bool | int | float | None
    path: str
    pos: ir.Pos
    setting: str = ""  # key of a value that was loaded from a file; else ""


class Origins:
    """Traces values back to the constants from which they come."""

    def __init__(self, machine: Linker) -> None:
        self.machine = machine
        self.graph = machine.graph
        self.tables = fallbacks.tables(machine.graph)
        self.topics: dict[Obj, frozenset[str]] = {}
        for record in machine.sources.values():
            for message in record.messages.values():
                self.topics[message] = frozenset(t.lstrip("/") for t in record.topics)

    def of(self, expr: ir.Expr, value: Value | None) -> frozenset[Origin]:
        """Return the origins of an expression's possible constants; empty if the expression may be anything else."""
        if isinstance(expr, ir.Const):
            if isinstance(expr.value, (bool, int, float)):
                return frozenset([Origin(expr.value, "", expr.pos)])
            return frozenset()
        if value is None:
            return frozenset()
        if value.pts:
            # `min(value, limit)` is not constant if messages set the value
            constant = self.graph.live.isdisjoint(value.deps)
            return self._loaded(value) if constant else frozenset()
        if not value.deps:
            return frozenset()
        found = self._trace(value.deps, set())
        pos = fallbacks.entry_place(expr)
        if found and pos is not None and all((one.path, one.pos) in self.tables for one in found):
            return frozenset([Origin(None, "", pos)])
        return frozenset(found) if found is not None else frozenset()

    def _loaded(self, value: Value) -> frozenset[Origin]:
        """Return the origin of a value loaded from a file; empty for a table, since only parts of a table are used."""
        settings = self.machine.settings
        if len(value.pts) != 1:
            return frozenset()
        (loaded,) = value.pts
        if loaded.whole not in settings or loaded.subs:
            return frozenset()
        path, pos = settings[loaded.whole]
        key = _dotted(loaded).rpartition(".")[2].strip("'\"")
        return frozenset([Origin(None, path, pos, "" if key.isdigit() else key)])

    def entries(self, value: Value | None, index: Value | None) -> frozenset[Origin]:
        """Return the origins of a table's numbers if a computed index selects one of these numbers; empty otherwise."""
        if value is None or index is None or value.pts:
            return frozenset()
        found = self._trace(value.deps - self.machine.use(index), set())
        numbers = found is not None and all(origin.value is not None for origin in found)
        return frozenset(found) if found and numbers else frozenset()

    def _trace(self, deps: Iterable[int], seen: set[int]) -> set[Origin] | None:
        """Return the constants from which nodes come; None if a node does not come from a constant."""
        found: set[Origin] = set()
        for node in sorted(deps):
            if node in seen:
                continue
            seen.add(node)
            literal = self.graph.literals.get(node)
            if literal is not None:
                if not self.graph.live.isdisjoint(self.graph.data[node]):
                    # constant only until the first message, as in `gain * self.error`
                    return None
                value, pos, path = literal
                found.add(Origin(value if isinstance(value, (bool, int, float)) else None, path, pos))
                continue
            if node in self.graph.parameters and not self.graph.data[node]:
                continue  # the node is a text that selects a constant, as in `RECIPES[fruit]`
            if node in self.graph.copies or node in self.graph.carried:
                inner = self._trace(self.graph.data[node], seen)
                if inner is None:
                    return None
                found |= inner
            elif node not in self.graph.held and not self._settled(
                node
            ):  # a node that passes on an object and nothing else has no constant
                return None
        return found

    def _settled(self, node: int) -> bool:
        """Return whether a node is None or a choice between constants, and is not reached by messages."""
        place = self.graph.places[node]
        if self.graph.data[node] or node in self.graph.live:
            return False
        made = place.statement.value if isinstance(place.statement, ir.Assign) else None
        return place.role == "condition" or (isinstance(made, ir.Const) and made.value is None)

    def unchanged(self, value: Value, topic: str, path: str) -> bool:
        """Return whether a value is a field of a topic's messages, or a constant set before the first message."""
        fields = 0
        for obj in value.objects:
            root = obj.whole
            if root in self.topics:
                if topic not in self.topics[root] or _dotted(obj) != path:
                    return False
                fields += 1
            elif obj.kind != "lib" or reachable_data.deep(self.machine, frozenset([obj])):
                return False
        return fields > 0 and self._copied(value.deps, set())

    def _copied(self, deps: Iterable[int], seen: set[int]) -> bool:
        for node in deps:
            if node in seen:
                continue
            seen.add(node)
            initial = not self.graph.data[node]
            copied = node in self.graph.copies or node in self.graph.carried
            if not initial and not (copied and self._copied(self.graph.data[node], seen)):
                return False
        return True

    def constant(self, value: Value) -> bool:
        """Return whether a value comes from constants alone, or is unset."""
        return value is BOTTOM or (not value.pts and all(not self.graph.data[d] for d in value.deps))


@dataclass(slots=True)
class Holding:
    """Possible contents of the variables at one statement, over all visits."""

    values: dict[str, Value] = field(default_factory=dict)
    fields: dict[tuple[str, str], Value] = field(default_factory=dict)  # (variable, field) → value

    # variable → whether the observed run wrote to the variable
    fresh: dict[str, bool] = field(default_factory=dict)

    delivered: set[Obj] = field(default_factory=set)  # messages that have just arrived

    def look(self, machine: Linker, frame: Frame) -> None:
        """Add the current contents of the variables."""
        self.delivered |= machine.delivered
        for name, value, written in _variables(machine, frame):
            self.fresh[name] = written and self.fresh.get(name, True)
            before = self.values.get(name)
            self.values[name] = value if before is None else join(before, value)
            if any(o.kind == "message" for o in value.pts):
                self._fields(machine, name, value)

    def _fields(self, machine: Linker, name: str, value: Value) -> None:
        """Read the fields of a stored message that the node wrote. They may no longer have the values of the topic."""
        pending: list[tuple[str, Value]] = [("", value)]
        while pending:
            path, current = pending.pop()
            for obj in current.objects:
                for part in [*obj.fields, *obj.subs]:
                    longer = f"{path}.{part}" if path else part
                    if (name, longer) in self.fields or part == "*" or longer.count(".") > 5:
                        continue
                    stored = heap.read(machine, Value(NONE, current.pts), part)
                    self.fields[name, longer] = stored
                    pending.append((longer, stored))

    def expressions(self, topic: str, path: str, origins: Origins) -> tuple[str, ...]:
        """Return the expressions that contain a topic's field, shortest first."""
        found: list[tuple[str, bool]] = []
        for name, value in self.values.items():
            for obj in value.objects:
                if obj.whole not in origins.topics:
                    continue
                rest = _rest(_dotted(obj), path)
                if rest is None or not origins.unchanged(value, topic, _dotted(obj)):
                    continue
                if self._intact(name, rest, obj, origins, topic):
                    found.append((name + _spelled(rest), self.fresh[name]))
                break
        arrived = any(topic in origins.topics.get(m, ()) for m in self.delivered)
        new = (
            [text for text, fresh in found if fresh] if arrived else []
        )  # a variable that was not written in this run still has the value from an earlier message
        texts = new or [text for text, _ in found]
        return tuple(sorted(texts, key=lambda text: (text.count("."), len(text), text)))

    def _intact(self, name: str, rest: str, obj: Obj, origins: Origins, topic: str) -> bool:
        """Return whether no field on the access path was written."""
        parts = rest.split(".") if rest else []
        outer = _dotted(obj)
        for count in range(1, len(parts) + 1):
            key = ".".join(parts[:count])
            whole = f"{outer}.{key}" if outer else key
            read = self.fields.get((name, key)) or self.fields.get((name, _bracketed(key)))
            if read is not None and not origins.unchanged(read, topic, whole):
                return False
        return True


def _variables(machine: Linker, frame: Frame) -> Iterator[tuple[str, Value, bool]]:
    """Yield the names in scope at a statement: locals, enclosing functions, globals, and their attributes."""
    seen: set[str] = set()
    count = 0
    around: Frame | None = frame
    holders: list[Obj] = []
    while around is not None:
        holders.append(around)
        around = around.outer
    for holder in (*holders, frame.module):
        for name in list(holder.fields):
            value = machine.store.get((holder, name)) if name not in seen and name.isidentifier() else None
            if value is None:
                continue
            seen.add(name)
            yield name, value, heap.written_here(machine, holder, name)
            yield from _attributes(machine, name, value)
            count += 1
            if count > MAX_VARIABLES:
                return


def _attributes(machine: Linker, owner: str, value: Value) -> Iterator[tuple[str, Value, bool]]:
    if len(value.pts) != 1:
        return
    obj = next(iter(value.pts))
    if obj.kind != "instance":
        return
    for name in list(obj.fields):
        inner = machine.store.get((obj, name))
        if inner is not None and name.isidentifier():
            yield f"{owner}.{name}", inner, heap.written_here(machine, obj, name)


def _dotted(obj: Obj) -> str:
    """Return the access path of an object within its message, with elements given by number: `ranges.0`."""
    return obj.path().replace("[", "").replace("]", "")


def _bracketed(path: str) -> str:
    return ".".join(f"[{p}]" if p.lstrip("-").isdigit() else p for p in path.split("."))


def _rest(have: str, want: str) -> str | None:
    """Return the rest of the path `want` after the prefix `have`; None if `have` is not a prefix."""
    if have == want:
        return ""
    if not have:
        return want
    return want[len(have) + 1 :] if want.startswith(f"{have}.") else None


def _spelled(rest: str) -> str:
    """Return a dotted field in Python syntax."""
    parts = rest.split(".") if rest else []
    return "".join(f"[{p}]" if p.lstrip("-").isdigit() else f".{p}" for p in parts)
