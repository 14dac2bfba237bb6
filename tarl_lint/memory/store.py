"""Memory: the state of one root's run, in layers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from tarl_lint.memory.cached_data import Contents, Inside, Split
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.shared import BORN, Root, Shared
from tarl_lint.memory.values import ABSENT, Key, Obj, Value, join

Delta = dict[Key, Value]
Made = dict[Obj, bool]  # object → whether it exists on the current path

CLEARED = frozenset(["lib", "sequence", "mapping"])  # kinds of objects whose allocation clears their fields
# kinds of objects for which the newest object of an allocation site is kept apart from older objects
AGING = frozenset(["lib", "instance", "sequence", "mapping"])
ADDING = frozenset(["*", "<keys>", "<length>"])  # names of the fields that get only weak updates


def private(key: Key) -> bool:
    """Return whether a variable is visible only inside its function call."""
    owner = key[0]
    return isinstance(owner, Frame) and not owner.captured


def as_it_is(key: Key, value: Value) -> Value:  # noqa: ARG001 - the signature of `gather`
    """Return the value unchanged."""
    return value


@dataclass(slots=True)
class Store:
    """The state of one root's run: writes go to the top layer, reads fall through to the shared memory.

    `now` is the union of all layers, so that a read takes one look-up. For each layer, `hidden` maps the keys of
    the layer to their earlier values; None if unset.
    """

    shared: Shared
    root: Root
    layers: list[Delta] = field(default_factory=lambda: [{}])
    seen: set[Obj] = field(default_factory=set)
    found: dict[Key, Value | None] = field(default_factory=dict)
    merged: set[Key] = field(default_factory=set)  # the keys of `found` that only joins have read
    exchanged: dict[Key, Value] = field(default_factory=dict)  # key → its value when this root last waited
    foreign: dict[Key, Value] = field(
        default_factory=dict
    )  # key → the part of its value that other roots stored while this root waited
    now: Delta = field(default_factory=dict)
    hidden: list[dict[Key, Value | None]] = field(default_factory=lambda: [{}])
    insides: dict[object, Inside] = field(default_factory=dict)  # cached results of `deep`
    # sets of few objects from which `deep` visits many objects
    wide: set[frozenset[Obj]] = field(default_factory=set)
    tick: int = 0  # number of changes so far to the part of the state that is outside frames
    split: dict[frozenset[Obj], Split] = field(default_factory=dict)
    versions: dict[Obj, int] = field(
        default_factory=dict
    )  # outermost object → `tick` of the last change to it or to an object inside it
    contents: dict[Obj, Contents] = field(default_factory=dict)
    elsewhere: dict[Key, Value | None] = field(
        default_factory=dict
    )  # key → value that other roots may store while this root waits; None if they store no value
    hearing: dict[Key, Value] | None = None
    unheard: list[Key] = field(
        default_factory=list
    )  # keys added to the root's `heeds` since `hearing` was computed
    waited: bool = False  # whether this root has waited, so that other roots may have stored since its start
    reads: Reads = field(default_factory=Reads)  # values and facts that the running call has read
    # function applied to each value that is stored to a field with weak updates
    gather: Callable[[Key, Value], Value] = as_it_is

    def get(self, key: Key) -> Value | None:
        """Return the current value; None if unset. Records the read."""
        value = self.now.get(key)
        reads = self.reads
        if self.waited:
            if key not in reads.written:
                reads.keys.add(key)
            return self.peek(key)
        if value is None:
            owner = key[0]
            whole = owner.outermost or owner
            # the same code as in `_new`, repeated here for speed, because most reads of the memory run this line
            if whole.kind in CLEARED and (born := (whole, BORN)) in self.now:
                if born not in reads.written:
                    reads.keys.add(key)
                return None
            if key not in reads.written:
                reads.keys.add(key)
            if key not in self.found:
                return self._first(key)
            if key in self.merged:
                self.merged.discard(key)
                self.shared.read(key, self.root)
            return self.found[key]
        if key not in reads.written:
            reads.keys.add(key)
        return None if value is ABSENT else value

    def peek(self, key: Key) -> Value | None:
        """Return the current value without recording the read for the running call."""
        value = self.now.get(key)
        if value is not None:
            if self.waited and key not in self.root.heeds and not private(key):
                self._heed(key, value)
            return None if value is ABSENT else value
        found = self.found
        if key in found:
            if key in self.merged:
                self.merged.discard(key)
                self.shared.read(key, self.root)
            return found[key]
        owner = key[0]
        if not self.waited and self._new(owner.outermost or owner):
            return None
        return self._first(key)

    def _first(self, key: Key) -> Value | None:
        """Return the initial value of a key that this root has not yet stored or read."""
        local = key[0].kind == "frame" and private(key)
        value = self.found[key] = None if local else self.shared.entry(key, self.root)
        return value

    def former(self, key: Key, made: Made) -> Value | None:
        """Return the current value of a key that another path stores, for the join with that value.

        If this run creates the object only on other paths, every run creates an object of its own. As long as only
        joins read the object's keys, the run's own stores to them do not make the root run again. `made` caches the
        results of the method `made` for this join.
        """
        if key in self.now or self.waited or not self._made_elsewhere(key[0].outermost or key[0], made):
            return self.get(key)
        if key not in self.reads.written:
            self.reads.keys.add(key)
        if key not in self.found:
            self.merged.add(key)
            self.found[key] = self.shared.entry(key, self.root, joining=True)
        return self.found[key]

    def made(self, whole: Obj, made: Made) -> bool:
        """Return whether an object exists on the current path; `made` caches results until the next store."""
        known = made.get(whole)
        if known is None:
            known = made[whole] = self.get((whole, BORN)) is not None
        return known

    def _made_elsewhere(self, whole: Obj, made: Made) -> bool:
        """Return whether an object belongs to a single run and does not exist on the current path."""
        if isinstance(whole, Frame):
            return whole.captured
        return BORN in whole.fields and not self.made(whole, made)

    def isolated(self, obj: Obj) -> bool:
        """Return whether an object currently contains only stores of this run."""
        return not self.waited and self._new(obj.outermost or obj)

    def _new(self, obj: Obj) -> bool:
        """Return whether the current path allocated an object; then other runs have not stored to its unset fields.

        Allocation clears every field to which any run has stored, so all other fields are unset everywhere.
        """
        return obj.kind in CLEARED and (obj, BORN) in self.now

    def _heed(self, key: Key, value: Value) -> None:
        """Take in stores of other roots at this key from now on. If other roots store there, run this root again."""
        self.root.heeds.add(key)
        self.unheard.append(key)
        self.exchanged.pop(key, None)
        news = self.others(key)
        if news is not None and (value is ABSENT or join(value, news) is not value):
            self.shared.dirty.add(self.root)

    def others(self, key: Key) -> Value | None:
        """Return the value that other roots may store here; constant during this run."""
        if key not in self.elsewhere:
            self.elsewhere[key] = self.shared.others(key, self.root)
        return self.elsewhere[key]

    def found_by(self, reads: Reads) -> tuple[dict[Key, Value | None], dict[Key, bool]]:
        """Return the current values of read keys and, for keys in `stored`, whether this run stored."""
        now, found, one = self.now, self.found, self.shared.one
        values: dict[Key, Value | None] = {}
        for key in reads.keys:
            key = one.setdefault(key, key)
            value = now.get(key)
            if value is None:
                value = found[key] if key in found else self.peek(key)
            values[key] = None if value is ABSENT else value
        return values, {one.setdefault(key, key): key in now for key in reads.stored}

    def stored(self, key: Key) -> bool:
        """Return whether this run has stored here. Records the read."""
        if key not in self.reads.written:
            self.reads.stored.add(key)
        return key in self.now

    def put(self, key: Key, value: Value) -> None:
        """Store a value (strong update)."""
        owner, name = key
        deps, pts = value.deps, value.pts
        if name in ADDING and len(deps) > 1:
            value = self.gather(key, value)
            deps, pts = value.deps, value.pts
        layer, now = self.layers[-1], self.now
        if key not in layer:
            self.hidden[-1][key] = now.get(key)
        layer[key] = now[key] = value
        self.reads.written.add(key)
        if owner.kind != "frame":
            self.tick += 1
            self.versions[owner.outermost or owner] = self.tick
        noted = owner.fields.get(name)
        laden = bool(deps)
        if noted is None or (pts is not noted and not pts <= noted):
            owner.fields[name] = pts
            if noted is None:
                owner.changed(name)
                self.shared.edition += name == "__dict__"
            if pts:
                laden = self._note(key, pts) or laden
        if laden and not owner.laden:
            self.shared.load(owner, self.root)

    def absorb(self, delta: Delta) -> None:
        """Store the changes of a closed layer again."""
        layer, hidden, now = self.layers[-1], self.hidden[-1], self.now
        for key, value in delta.items():
            if key not in layer:
                hidden[key] = now.get(key)
            layer[key] = now[key] = value
        self.reads.written.update(delta)
        self._change(delta)

    def _change(self, keys: Iterable[Key]) -> None:
        """Record a change of the values of some keys."""
        self.tick += 1
        versions, tick = self.versions, self.tick
        for owner, _ in keys:
            versions[owner.outermost or owner] = tick

    def _note(self, key: Key, held: frozenset[Obj]) -> bool:
        """Record the key that holds objects; return whether one of these objects holds data."""
        owner, laden = key[0], False
        for obj in held:
            if obj.kind in AGING:
                obj.holders[key] = None
            if obj.laden:
                laden = True
            elif not owner.laden:
                obj.inside[owner] = None
        return laden

    def doubt(self, obj: Obj) -> bool:
        """Record that this run found no data inside an object; return whether other runs can store data there."""
        self.reads.look(obj)
        if self.isolated(obj):
            return False
        doubters = self.shared.doubters.get(obj)
        if doubters is None:
            doubters = self.shared.doubters[obj] = set()
        doubters.add(self.root)
        return True

    def look(self, obj: Obj) -> None:
        """Record that this run depends on the set of an object's fields."""
        self.reads.look(obj)
        if obj not in self.seen and not self.isolated(obj):
            self.seen.add(obj)
            self.shared.look(obj, self.root)

    def push(self, delta: Delta | None = None) -> None:
        """Open a layer."""
        if not delta:
            self.layers.append({})
            self.hidden.append({})
            return
        self._change(delta)
        self.layers.append(dict(delta))
        self.hidden.append({key: self.now.get(key) for key in delta})
        self.now.update(delta)
        self.reads.written.update(delta)

    def pop(self) -> Delta:
        """Close the top layer and return it."""
        hidden = self.hidden.pop()
        self._change(hidden)
        self.reads.written.difference_update(hidden)
        self.reads.left += 1
        now = self.now
        for key, value in hidden.items():
            if value is None:
                del now[key]
            else:
                now[key] = value
        return self.layers.pop()

    def cut(self, depth: int) -> None:
        """Close all layers above the first `depth`."""
        while len(self.layers) > depth:
            self.pop()

    def since(self, depth: int) -> Delta:
        """Return the stores in all layers above the first `depth`."""
        merged: Delta = dict(self.layers[depth])
        for layer in self.layers[depth + 1 :]:
            merged.update(layer)
        return merged

    def admit(self, key: Key, mine: Value, news: Value) -> Value:
        """Return a value joined with the value of other roots; record the part that only other roots stored."""
        both = join(mine, news)
        if both is not mine:
            theirs = Value(both.deps - mine.deps, both.pts - mine.pts, frozenset())
            self.take(key, theirs)
        return both

    def take(self, key: Key, theirs: Value) -> None:
        """Record the part of a stored value that came from other roots."""
        self.foreign[key] = join(self.foreign.get(key, theirs), theirs)
        self.reads.admit(key, theirs)

    def mine(self, key: Key, value: Value) -> Value | None:
        """Return the part of a value that this root stored itself; None if there is none."""
        known = [v for v in (self.foreign.get(key), self.found.get(key)) if v is not None]
        if not known:
            return value
        theirs = join(known[0], known[-1])
        part = Value(value.deps - theirs.deps, value.pts - theirs.pts, value.consts)
        news = part.deps or part.pts or not value.consts_in(theirs)
        return part if news or not (value.deps or value.pts) else None

    def heard(self) -> dict[Key, Value]:
        """Return the values that other roots may store at the keys in `heeds`; constant during this root's run.

        Keys to which only this root stores are left out, so that adding such a key to `heeds` does not change the
        result. The result is not modified later; if keys are added, the next result is another dictionary.
        """
        if self.hearing is None or self.unheard:
            news = (
                (key, self.others(key)) for key in (self.root.heeds if self.hearing is None else self.unheard)
            )
            added = {key: value for key, value in news if value is not None}
            if added or self.hearing is None:
                self.hearing = {**(self.hearing or {}), **added}
            self.unheard = []
        return self.hearing

    def own(self) -> list[Key]:
        """Return the keys written in this run that are visible to other roots."""
        return [key for key in self.now if not private(key)]
