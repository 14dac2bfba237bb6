"""What goes over elements: zip, enumerate, map and filter, and the sequences that they give."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.calls import Calls
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import LENGTH, item_field
from tarl_lint.valueflow.invocation import Invocation
from tarl_lint.valueflow.values import NONE, UNKNOWN, Nodes, Value, const, join_all, pointer

MAX_ROWS = 8  # elements of zip, enumerate and map that are told apart


class Iterating(Calls):
    """Goes over the elements of sequences."""

    def listed(self, element: Value, length: Nodes, it: Invocation) -> Value:
        """Return a new sequence of elements that are not told apart."""
        obj = self.allocate("sequence", it.frame, ("values", it.call.slot))
        self.add_element(pointer(obj), element)
        self.store.put((obj, LENGTH), Value(length))
        return pointer(obj)

    def pairs(self, parts: list[Value], frame: Frame, call: ir.Call, length: Nodes) -> Value:
        """Return a sequence of tuples."""
        pair = self.allocate("sequence", frame, ("pair", call.slot))
        for number, part in enumerate(parts):
            self.store.put((pair, item_field(number)), part)
        obj = self.allocate("sequence", frame, ("pairs", call.slot))
        self.add_element(pointer(obj), pointer(pair))
        self.store.put((obj, LENGTH), Value(length))
        return pointer(obj)

    def _zipped(self, it: Invocation) -> Value:
        if it.name == "zip" and "*" in it.arguments[1] and not it.arguments[0]:
            return self._transposed(it.arguments[1]["*"], it)
        known = [self.unpacked(v) for v in it.arguments[0]]
        if it.name == "enumerate" and known and known[0] is not None:
            known.insert(0, [const(n) for n in range(len(known[0]))] if len(known) == 1 else None)
        rows = list(zip(*(k for k in known if k is not None), strict=False)) if None not in known else []
        if rows and len(rows) <= MAX_ROWS:
            return self._rows(rows, it)
        parts = [self.elements(v) for v in it.arguments[0]]
        length = self.lengths(it.arguments[0])
        return self.pairs([UNKNOWN, *parts] if it.name == "enumerate" else parts, it.frame, it.call, length)

    def lengths(self, values: Sequence[Value]) -> Nodes:
        """Return the nodes that the lengths of several values are data of."""
        return NONE.union(*map(self.length, values))

    def _transposed(self, row: Value, it: Invocation) -> Value:
        """Return what `zip(*rows)` gives: a sequence for each place in a row."""
        places = self.one_by_one(row) or [self.elements(row)]
        obj = self.allocate("sequence", it.frame, ("pairs", it.call.slot))
        for number, place in enumerate(places):
            column = self.allocate("sequence", it.frame, ("column", it.call.slot, number))
            self.add_element(pointer(column), place)
            if len(places) > 1:
                self.store.put((obj, item_field(number)), pointer(column))
            else:
                self.add_element(pointer(obj), pointer(column))
        return pointer(obj)

    def _rows(self, rows: Sequence[Sequence[Value]], it: Invocation) -> Value:
        """Return a sequence of tuples whose elements are told apart."""
        obj = self.allocate("sequence", it.frame, ("pairs", it.call.slot))
        for number, row in enumerate(rows):
            pair = self.allocate("sequence", it.frame, ("pair", it.call.slot, number))
            for place, part in enumerate(row):
                self.store.put((pair, item_field(place)), part)
            self.store.put((obj, item_field(number)), pointer(pair))
        return pointer(obj)

    def _each(self, function: Value, rows: Sequence[Sequence[Value]], it: Invocation) -> Value:
        """Return what a function gives for known elements, one by one."""
        obj = self.allocate("sequence", it.frame, ("values", it.call.slot))
        for number, row in enumerate(rows):
            call = replace(it.call, slot=-1000 * (abs(it.call.slot) + 1) - number)
            said = self.call_value(function, (list(row), {}), it.frame, call)
            self.store.put((obj, item_field(number)), said)
        return pointer(obj)

    def _mapped(self, it: Invocation) -> Value:
        function, *rest = it.arguments[0] or [UNKNOWN]
        known = [self.unpacked(v) for v in rest]
        rows = list(zip(*(k for k in known if k is not None), strict=False)) if None not in known else []
        if it.name == "map" and rows and len(rows) <= MAX_ROWS:
            return self._each(function, rows, it)
        parts = [self.elements(v) for v in rest]
        length = self.lengths(rest)
        if it.name == "map":
            return self.listed(self.call_value(function, (parts, {}), it.frame, it.call), length, it)
        kept = join_all(parts)
        asks = kept if function.consts else self.call_value(function, (parts, {}), it.frame, it.call)
        gate = self.gate(self.truth(asks, it.frame, ("filter", it.call.slot)), it.frame, it.call.slot)
        return self.listed(Value(kept.deps | gate, kept.pts, kept.consts), length | gate, it)

    def gate(self, decides: Nodes, frame: Frame, slot: Hashable) -> Nodes:
        """Return the node of a decision which elements a new container gets, none where no data decides."""
        if not decides:
            return NONE
        node = self.node(frame, ("filter", slot), "condition")
        self.graph.depend(node, decides)
        return frozenset([node])

    def ordered_by(self, elements: Value, it: Invocation) -> Value:
        """Return elements as chosen or ordered by `key=`: what the function says of them decides which is where."""
        key = it.arguments[1].get("key")
        if key is None or key.consts or not elements.deps | elements.pts | key.pts:
            return elements
        said = self.call_value(key, ([elements], {}), it.frame, it.call)
        return Value(elements.deps | self.use(said), elements.pts, elements.consts)

    def asked(self, it: Invocation) -> Value:
        """Return what `bool(x)`, `any(xs)` and `all(xs)` say: whether something is there is no data of it."""
        if not it.arguments[0]:
            return UNKNOWN
        value = it.arguments[0][0]
        known, constant = value.constant()
        if it.name == "bool" and known:
            return Value(value.deps, consts=frozenset([bool(constant)]))
        parts, deps = [value], NONE
        if it.name != "bool":
            each = self.unpacked(value)
            parts = each if each is not None else [self.elements(value)]
            deps = value.deps if each is not None else self.length(value)
        for number, part in enumerate(parts):
            deps |= self.truth(part, it.frame, (it.name, it.call.slot, number))
        return Value(deps)
