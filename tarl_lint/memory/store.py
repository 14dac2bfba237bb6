"""Memory: the state of one run in layers, and what all runs have stored."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.values import ABSENT, Key, Obj, Value, join

Delta = dict[Key, Value]

ADDING = frozenset(["*", "<keys>", "<length>"])  # fields where everything adds up
BORN = "<born>"  # the field that every object has which exists


@dataclass(slots=True, eq=False)
class Root:
    """What ROS, the interpreter or a thread runs on its own. `once`: it does not run beside an earlier self."""

    key: Hashable
    kind: str
    name: str = ""
    once: bool = False
    function: ir.Function | None = None  # what it runs, where that is known
    maker: Root | None = None  # in whose run it was added
    program: str = ""  # the file that it is of, whose budget it spends
    number: int = 0  # in the order in which they were added
    heeds: set[Key] = field(default_factory=set)  # what it stores itself and reads after it has waited

    def generations(self) -> int:
        """Count the roots before that run the same function, each of which led to the next."""
        count, maker = 0, self.maker
        while maker is not None:
            count += maker.function is self.function
            maker = maker.maker
        return count


NOBODY: set[Root] = set()


@dataclass(slots=True)
class Shared:
    """What each root leaves behind at its end, and what others can see of it while it waits."""

    ends: dict[Key, dict[Root, Value]] = field(default_factory=dict)
    pauses: dict[Key, dict[Root, Value]] = field(default_factory=dict)
    readers: dict[Key, set[Root]] = field(default_factory=dict)
    watchers: dict[Obj, set[Root]] = field(default_factory=dict)
    doubters: dict[Obj, set[Root]] = field(default_factory=dict)  # roots that found no data inside an object
    dirty: set[Root] = field(default_factory=set)
    edition: int = 0  # how often a class, a `from … import *` or a whole `__dict__` was news

    def entry(self, key: Key, root: Root) -> Value | None:
        """Return what a root finds when it starts: the join of all that any other can have stored."""
        self.readers.setdefault(key, set()).add(root)
        result: Value | None = None
        for owner, value in self.ends.get(key, {}).items():
            if owner is not root or not root.once:
                result = value if result is None else join(result, value)
        for owner, value in self.pauses.get(key, {}).items():
            if owner is not root:
                result = value if result is None else join(result, value)
        return result

    def others(self, key: Key, root: Root) -> Value | None:
        """Return what other roots may store while this one waits."""
        result: Value | None = None
        for table in (self.ends, self.pauses):
            for owner, value in table.get(key, {}).items():
                if owner is not root:
                    result = value if result is None else join(result, value)
        self.readers.setdefault(key, set()).add(root)
        return result

    def look(self, obj: Obj, root: Root) -> None:
        """Remember that a root has seen which fields an object has."""
        self.watchers.setdefault(obj, set()).add(root)

    def load(self, obj: Obj, root: Root) -> None:
        """Note that data was stored in an object, so that it is inside all that hold it, too."""
        pending = [obj]
        while pending:
            current = pending.pop()
            if current.laden:
                continue
            current.laden = True
            current.stamp += 1
            self.dirty |= self._others(self.doubters.pop(current, None), root)
            pending += current.inside
            pending += current.subs.values()
            pending += [current.parent] if current.parent is not None else []
            current.inside.clear()

    def _appeared(self, obj: Obj, root: Root) -> None:
        """Let those run again who have seen an object, or what it is inside, without this field."""
        inside: Obj | None = obj
        while inside is not None:
            self.dirty |= self._others(self.watchers.get(inside), root)
            inside = inside.parent

    def _others(self, roots: set[Root] | None, root: Root) -> set[Root]:
        """Return those for whom it is news what a root did: itself only if it may run beside itself."""
        if not roots:
            return NOBODY
        return roots - {root} if root.once else roots

    def leave(self, table: dict[Key, dict[Root, Value]], root: Root, key: Key, value: Value) -> None:
        """Record a value; roots that read it have to run again when it is news."""
        owners = table.setdefault(key, {})
        before = owners.get(root)
        after = value if before is None else join(before, value)
        if key[1] == BORN:  # who can see the object has seen what holds it
            owners[root] = after
            return
        if not owners:
            self._appeared(key[0], root)
        if before is None or after != before:
            owners[root] = after
            self.dirty |= self._others(self.readers.get(key), root)


def private(key: Key) -> bool:
    """Tell whether a variable dies with its function."""
    owner = key[0]
    return isinstance(owner, Frame) and not owner.captured


@dataclass(slots=True, eq=False)
class Inside:
    """The data inside objects when somebody looked last, and what was read to find it."""

    nodes: frozenset[int]
    reads: Reads
    found: dict[Key, Value | None]
    stored: dict[Key, bool]
    tick: int
    grown: int  # how often something new was inside an object that was passed on


def as_it_is(key: Key, value: Value) -> Value:  # noqa: ARG001 - as other ways to gather
    """Return a value unchanged."""
    return value


@dataclass(slots=True)
class Store:
    """The state of one root's run: writes go to the top layer, reads fall through to the shared memory.

    `now` is what all layers together say, so that reading takes one step however many there are; `hidden` holds
    for each layer what its keys were before, None where nothing was stored.
    """

    shared: Shared
    root: Root
    layers: list[Delta] = field(default_factory=lambda: [{}])
    seen: set[Obj] = field(default_factory=set)
    found: dict[Key, Value | None] = field(default_factory=dict)
    exchanged: dict[Key, Value] = field(default_factory=dict)  # at the last wait
    foreign: dict[Key, Value] = field(default_factory=dict)  # what others stored while this root waited
    now: Delta = field(default_factory=dict)
    hidden: list[dict[Key, Value | None]] = field(default_factory=lambda: [{}])
    insides: dict[object, Inside] = field(
        default_factory=dict
    )  # data inside objects when somebody looked last
    tick: int = 0  # how often the state outside of activations may have changed
    elsewhere: dict[Key, Value | None] = field(
        default_factory=dict
    )  # what other roots may store while this one waits
    hearing: dict[Key, Value | None] = field(default_factory=dict)
    waited: bool = False  # so that others may have stored meanwhile
    reads: Reads = field(default_factory=Reads)  # of the call that is running
    gather: Callable[[Key, Value], Value] = as_it_is  # what becomes of a value where everything adds up

    def get(self, key: Key) -> Value | None:
        """Return the value now, None where nothing was stored."""
        reads = self.reads
        if key not in reads.written:
            reads.keys.add(key)
        return self.peek(key)

    def peek(self, key: Key) -> Value | None:
        """Return the value now without noting that the running call reads it."""
        value = self.now.get(key)
        if value is not None:
            if self.waited and key not in self.root.heeds and not private(key):
                self._heed(key, value)
            return None if value is ABSENT else value
        if key in self.found:
            return self.found[key]
        value = None if private(key) else self.shared.entry(key, self.root)
        self.found[key] = value
        return value

    def _heed(self, key: Key, value: Value) -> None:
        """From now on, take in what others store here meanwhile; run again if they have."""
        self.root.heeds.add(key)
        self.exchanged.pop(key, None)
        news = self.others(key)
        if news is not None and (value is ABSENT or join(value, news) is not value):
            self.shared.dirty.add(self.root)

    def others(self, key: Key) -> Value | None:
        """Return what other roots may store here, which does not change while this one runs."""
        if key not in self.elsewhere:
            self.elsewhere[key] = self.shared.others(key, self.root)
        return self.elsewhere[key]

    def found_by(self, reads: Reads) -> tuple[dict[Key, Value | None], dict[Key, bool]]:
        """Return what is where something was read, and whether this run stored there where that was asked."""
        now, found = self.now, self.found
        values: dict[Key, Value | None] = {}
        for key in reads.keys:
            value = now.get(key)
            if value is None:
                value = found[key] if key in found else self.peek(key)
            values[key] = None if value is ABSENT else value
        return values, {key: key in now for key in reads.stored}

    def stored(self, key: Key) -> bool:
        """Tell whether this run has stored here."""
        if key not in self.reads.written:
            self.reads.stored.add(key)
        return key in self.now

    def put(self, key: Key, value: Value) -> None:
        """Store for certain."""
        if key[1] in ADDING and len(value.deps) > 1:
            value = self.gather(key, value)
        layer = self.layers[-1]
        if key not in layer:
            self.hidden[-1][key] = self.now.get(key)
        layer[key] = self.now[key] = value
        self.reads.written.add(key)
        owner, name = key
        if owner.kind != "frame":
            self.tick += 1
        noted = owner.fields.get(name)
        laden = bool(value.deps)
        if noted is None or (value.pts is not noted and not value.pts <= noted):
            owner.fields[name] = value.pts
            if noted is None:
                owner.stamp += 1
                self.shared.edition += name == "__dict__"
            laden = self._note(key, value.pts) or laden
        if laden and not owner.laden:
            self.shared.load(owner, self.root)

    def absorb(self, delta: Delta) -> None:
        """Store for certain what was stored before in a layer that is closed."""
        layer, hidden, now = self.layers[-1], self.hidden[-1], self.now
        for key, value in delta.items():
            if key not in layer:
                hidden[key] = now.get(key)
            layer[key] = now[key] = value
        self.reads.written.update(delta)
        self.tick += 1

    def _note(self, key: Key, held: frozenset[Obj]) -> bool:
        """Have objects know where they are held; tell whether data is in one of them."""
        owner, laden = key[0], False
        for obj in held:
            if obj.kind == "lib":
                obj.holders[key] = None
            if obj.laden:
                laden = True
            elif not owner.laden:
                obj.inside[owner] = None
        return laden

    def doubt(self, obj: Obj) -> None:
        """Remember that this run found no data inside an object."""
        self.reads.look(obj)
        self.shared.doubters.setdefault(obj, set()).add(self.root)

    def look(self, obj: Obj) -> None:
        """Remember that this run depends on which fields an object has."""
        self.reads.look(obj)
        if obj not in self.seen:
            self.seen.add(obj)
            self.shared.look(obj, self.root)

    def push(self, delta: Delta | None = None) -> None:
        """Open a layer."""
        if not delta:
            self.layers.append({})
            self.hidden.append({})
            return
        self.tick += 1
        self.layers.append(dict(delta))
        self.hidden.append({key: self.now.get(key) for key in delta})
        self.now.update(delta)
        self.reads.written.update(delta)

    def pop(self) -> Delta:
        """Close the top layer and return it."""
        self.tick += 1
        hidden = self.hidden.pop()
        self.reads.written.difference_update(hidden)
        self.reads.left += 1
        for key, value in hidden.items():
            if value is None:
                del self.now[key]
            else:
                self.now[key] = value
        return self.layers.pop()

    def cut(self, depth: int) -> None:
        """Close all layers above a number of them."""
        while len(self.layers) > depth:
            self.pop()

    def since(self, depth: int) -> Delta:
        """Return all that was stored above a number of layers."""
        merged: Delta = dict(self.layers[depth])
        for layer in self.layers[depth + 1 :]:
            merged.update(layer)
        return merged

    def admit(self, key: Key, mine: Value, news: Value) -> Value:
        """Return a value joined with what others may have stored, and remember which part is theirs."""
        both = join(mine, news)
        if both is not mine:
            theirs = Value(both.deps - mine.deps, both.pts - mine.pts, frozenset())
            self.take(key, theirs)
        return both

    def take(self, key: Key, theirs: Value) -> None:
        """Remember which part of what is stored came from others."""
        self.foreign[key] = join(self.foreign.get(key, theirs), theirs)
        self.reads.admit(key, theirs)

    def mine(self, key: Key, value: Value) -> Value | None:
        """Return the part of a value that this root stored itself, None when there is none."""
        known = [v for v in (self.foreign.get(key), self.found.get(key)) if v is not None]
        if not known:
            return value
        theirs = join(known[0], known[-1])
        part = Value(value.deps - theirs.deps, value.pts - theirs.pts, value.consts)
        news = part.deps or part.pts or not value.consts_in(theirs)
        return part if news or not (value.deps or value.pts) else None

    def heard(self) -> dict[Key, Value | None]:
        """Return what others may store where this root takes it in, which does not change while it runs."""
        if len(self.hearing) != len(self.root.heeds):
            self.hearing = {key: self.others(key) for key in self.root.heeds}
        return self.hearing

    def own(self) -> list[Key]:
        """Return the keys written in this run which others can see."""
        return [key for key in self.now if not private(key)]
