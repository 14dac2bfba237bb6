"""Displays of sequences and mappings, comprehensions, and taking elements out."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import LENGTH, item_field
from tarl_lint.valueflow.operators import Operators
from tarl_lint.valueflow.values import NONE, Value, pointer

MAX_EACH = 4  # elements that a comprehension takes one by one


class Displays(Operators):
    """Evaluates what makes containers."""

    def _sequence(self, expr: ir.SequenceDisplay, frame: Frame) -> Value:
        obj = self.allocate("sequence", frame, ("display", expr.slot))
        items = [(i, self.evaluate(i.value if isinstance(i, ir.Starred) else i, frame)) for i in expr.items]
        where = pointer(obj)
        exact = True
        for number, (item, value) in enumerate(items):
            value = self.entry(item, value, frame, (expr.slot, number))
            self.note_passed((obj, item_field(number)), item, value, frame)
            if isinstance(item, ir.Starred):
                exact = False
                self.add_element(where, self.elements(value))
                self.lengthen(obj, value)
            elif exact:
                self.store.put((obj, item_field(number)), value)
            else:
                self.add_element(where, value)
        return where

    def _mapping(self, expr: ir.MappingDisplay, frame: Frame) -> Value:
        obj = self.allocate("mapping", frame, ("display", expr.slot))
        where = pointer(obj)
        for key, item in expr.items:
            value = self.entry(item, self.evaluate(item, frame), frame, (expr.slot, item.pos))
            if key is None:
                self.absorb(obj, value)
            else:
                self.write_item(where, self.evaluate(key, frame), value)
        return where

    def entry(self, expr: ir.Expr, value: Value, frame: Frame, slot: object) -> Value:
        """Return an element of a display; numbers get a node of their own, so that they are found again."""
        if not isinstance(expr, ir.Const) or not isinstance(expr.value, (int, float)):
            return value
        node = self.node(frame, ("entry", slot), "assign")
        self.mark(node, expr, value, frame)
        return self.carry(value, node)

    def _comprehension(self, expr: ir.Comprehension, frame: Frame) -> Value:
        kind = "mapping" if expr.key is not None else "sequence"
        first = self.evaluate(expr.loops[0][1], frame)
        known = self.unpacked(first)
        plain = expr.key is None and len(expr.loops) == 1 and not expr.loops[0][2]
        if plain and known and len(known) <= MAX_EACH:
            return self._one_by_one_of(expr, known, frame)
        obj = self.allocate(kind, frame, ("display", expr.slot))
        deps, lengths = NONE, NONE
        for number, (target, source, conditions) in enumerate(expr.loops):
            several = self.evaluate(source, frame) if number else first
            lengths |= self.length(several)
            self.assign(target, self.elements(several), frame)
            for condition in conditions:
                deps |= self.use(self.evaluate(condition, frame))
        element = self.evaluate(expr.element, frame)
        gate = self.gate(deps, frame, expr.slot)
        element = Value(element.deps | gate, element.pts, element.consts)
        self.store.put((obj, LENGTH), Value(lengths | gate))
        if expr.key is not None:
            self.write_item(pointer(obj), self.evaluate(expr.key, frame), element)
        else:
            self.add_element(pointer(obj), element)
        return pointer(obj)

    def _one_by_one_of(self, expr: ir.Comprehension, known: list[Value], frame: Frame) -> Value:
        """Return a sequence of what a comprehension makes of elements that are told apart."""
        obj = self.allocate("sequence", frame, ("display", expr.slot))
        turn = frame.turn
        for number, value in enumerate(known):
            frame.turn = (*turn, expr.slot, number)
            self.assign(expr.loops[0][0], value, frame)
            self.store.put((obj, item_field(number)), self.evaluate(expr.element, frame))
        frame.turn = turn
        return pointer(obj)

    def mark(self, node: int, expr: ir.Expr, value: Value, frame: Frame) -> None:
        """Note that a node is a constant, or passes on another unchanged."""
        known, constant = value.constant()
        if (
            isinstance(expr, (ir.Name, ir.Attribute, ir.Item))
            or _conversion(expr)
            or self._parameter_call(expr, value)
        ):
            self.graph.copies.add(node)
        elif known and isinstance(constant, (bool, int, float)):
            self.graph.literals[node] = (constant, expr.pos, frame.program.path)

    def _parameter_call(self, expr: ir.Expr, value: Value) -> bool:
        """Tell whether an expression is a call that gives a ROS parameter."""
        return isinstance(expr, ir.Call) and bool(value.deps) and value.deps <= self.graph.parameters


def _conversion(expr: ir.Expr) -> bool:
    """Tell whether an expression is `float(x)`, which leaves the number what it is."""
    return isinstance(expr, ir.Call) and isinstance(expr.function, ir.Name) and expr.function.name == "float"
