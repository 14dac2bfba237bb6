"""Statements: what each does to the state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.bounds import LOOKS
from tarl_lint.valueflow.control import raised
from tarl_lint.valueflow.defining import Defining
from tarl_lint.valueflow.ends import Publisher
from tarl_lint.valueflow.frames import Escape, Frame
from tarl_lint.valueflow.heap import item_field
from tarl_lint.valueflow.invocation import Invocation
from tarl_lint.valueflow.lower import lower_body
from tarl_lint.valueflow.presence import RETURNED
from tarl_lint.valueflow.values import ABSENT, BOTTOM, UNKNOWN, Obj, Value, const, join, lineage


class Execution(Defining):
    """Executes statements. A block tells whether execution can go on after it."""

    def run(self, frame: Frame) -> Value:
        """Execute a frame's body and return its result."""
        frame.returns = []
        depth = len(self.store.layers) - 1
        if self.block(lower_body(frame.function, frame.program.package), frame):
            frame.returns.append((self.store.since(depth), const(None)))
        result = BOTTOM
        for _, value in frame.returns:
            result = join(result, value)
        frame.result = join(frame.result, result)
        return result

    def block(self, body: Sequence[ir.Stmt], frame: Frame) -> bool:
        """Execute statements in order."""
        for statement in body:
            frame.statement = statement
            self.spent += 1
            if self.graph.asked > LOOKS:
                self.count()
            if self.watch is not None:
                self.watch(frame, statement)
            if not EXECUTE[type(statement)](self, statement, frame):
                return False
        return True

    # --- simple statements --------------------------------------------------------------------------------

    def _assignment(self, s: ir.Assign, frame: Frame) -> bool:
        value = self.evaluate(s.value, frame)
        frame.statement = s
        for number, target in enumerate(s.targets):
            self.bind_target(target, value, frame, str(number), s.value)
        return True

    def bind_target(self, target: ir.Expr, value: Value, frame: Frame, slot: str, source: ir.Expr) -> None:
        """Let a value pass through the statement into a target, element by element."""
        if isinstance(target, ir.SequenceDisplay):
            self.unpack(target, value, frame, slot, source)
            return
        if isinstance(target, ir.Starred):
            target = target.value
        self.note_absence(target, source, value, frame)
        node = self.node(frame, ("target", slot), "assign")
        self.mark(node, source, value, frame)
        self.assign(target, self.carry(value, node), frame)

    def unpack(
        self, target: ir.SequenceDisplay, value: Value, frame: Frame, slot: str, source: ir.Expr
    ) -> None:
        """Take a value apart."""
        starred = next((n for n, t in enumerate(target.items) if isinstance(t, ir.Starred)), None)
        parts = self.parts(value, len(target.items), starred, frame, slot)
        for number, (item, part) in enumerate(zip(target.items, parts, strict=True)):
            expr = source
            if isinstance(source, ir.SequenceDisplay) and number < len(source.items) and starred is None:
                expr = source.items[number]
            self.bind_target(item, part, frame, f"{slot}.{number}", expr)
            if starred is None:
                self.note_taken(item, value, number, part, frame)

    def assign(self, target: ir.Expr, value: Value, frame: Frame) -> None:
        """Store into a target."""
        if isinstance(target, ir.Name):
            self.store.put((self.holder(target, frame), target.name), value)
        elif isinstance(target, ir.Attribute):
            base = self.evaluate(target.base, frame)
            if not base.pts:
                self.assign_fallback(target.base, value, frame)
            elif not self.set_property(base, target, value, frame):
                self.write_field(base, target.name, value)
        elif isinstance(target, ir.Item):
            self._assign_item(target, value, frame)
        elif isinstance(target, ir.SequenceDisplay):
            for number, item in enumerate(target.items):
                self.assign(item, self.read_item(value, const(number)), frame)
        elif isinstance(target, ir.Starred):
            self.assign(target.value, value, frame)

    def _assign_item(self, target: ir.Item, value: Value, frame: Frame) -> None:
        base, index = self.evaluate(target.base, frame), self.evaluate(target.index, frame)
        if self.special(base, "__setitem__", [index, value], frame, target.pos) is not None:
            return
        if (index.deps or index.pts) and any(o.kind == "mapping" for o in base.pts):
            index = self.carry(index, self.node(frame, ("key", target.pos), "assign"))
        if isinstance(target.index, ir.Slice):
            self.remove(base, target.index, frame)
            value = self.elements(value)
        if where := self.use(index):
            chosen = Value(value.deps | where, value.pts)
            value = self.carry(chosen, self.node(frame, ("at", target.pos), "assign"))
        if base.pts:
            self.write_item(base, index, value)
        else:
            self.assign_fallback(target.base, value, frame)

    def set_property(self, base: Value, target: ir.Attribute, value: Value, frame: Frame) -> bool:
        """Call the setter where the attribute is a property."""
        done = False
        if target.name not in self.setters:
            return done
        for obj in base.pts:
            cls = obj.info if obj.kind == "instance" else None
            for owner in lineage(cls) if isinstance(cls, Obj) else ():
                setter = self.store.get((owner, f"{target.name}.setter"))
                if setter is not None:
                    call = ir.Call(target, (), (), target.pos, -target.slot)
                    self.call_value(self.bind(setter, obj, owner), ([value], {}), frame, call)
                    done = True
                    break
        return done

    def assign_fallback(self, expr: ir.Expr, value: Value, frame: Frame) -> None:
        """Add data to the variable that holds an object of which nothing is known."""
        if self.nothing_yet(self.evaluate(expr, frame)):
            return
        while isinstance(expr, (ir.Item, ir.Attribute)):
            if isinstance(expr, ir.Attribute) and self.evaluate(expr.base, frame).pts:
                break
            expr = expr.base
        if isinstance(expr, (ir.Name, ir.Attribute)):
            before = self.evaluate(expr, frame)
            self.assign(expr, Value(before.deps | self.use(value), before.pts), frame)

    def _expression(self, s: ir.Evaluate, frame: Frame) -> bool:
        self.evaluate(s.value, frame)
        return True

    def _returned(self, s: ir.Return, frame: Frame) -> bool:
        value = self.evaluate(s.value, frame) if s.value is not None else const(None)
        frame.statement = s
        if s.value is not None:
            node = self.node(frame, ("return",), "return")
            self.mark(node, s.value, value, frame)
            self.note_passed((frame, RETURNED), s.value, value, frame)
            value = self.carry(value, node)
            if isinstance(frame.answer, Publisher):
                self.send(Invocation("response", BOTTOM, ([value], {}), frame, _answer(s)), frame.answer)
        frame.returns.append((self.store.since(self.base_layer(frame)), value))
        return False

    def base_layer(self, frame: Frame) -> int:
        """Return the number of layers below a frame's own."""
        return frame.depth_of_layers

    def _raised(self, s: ir.Raise, frame: Frame) -> bool:
        value = UNKNOWN
        if s.value is not None:
            value = self.evaluate(s.value, frame)
            frame.statement = s
            if any(o.kind == "class" for o in value.pts):
                value = self.call_value(value, ([], {}), frame, ir.Call(s.value, (), (), s.pos, -1))
            whole = Value(self.use(value), value.pts)  # what is inside is forgotten with the function's state
            value = self.carry(whole, self.node(frame, ("raise",), "call"))
        if frame.tries:
            attempt = frame.tries[-1]
            attempt.states.append(self.store.since(attempt.depth))
        self.leave(Escape(frame, s, raised(s.value), value), frame)
        return False

    def _jump(self, s: ir.Jump, frame: Frame) -> bool:
        if frame.jumps:
            depth, table = frame.jumps[-1]
            table[s.kind].append(self.store.since(depth))
        return False

    def _delete(self, s: ir.Delete, frame: Frame) -> bool:
        for target in s.targets:
            if isinstance(target, ir.Name):
                self.store.put((self.holder(target, frame), target.name), UNKNOWN)
            elif isinstance(target, ir.Item):
                self.remove(self.evaluate(target.base, frame), target.index, frame)
        return True

    def remove(self, base: Value, index: ir.Expr, frame: Frame) -> None:
        """Take an element out of a mapping, or all elements out of a sequence."""
        known, key = self.evaluate(index, frame).constant()
        for obj in base.pts if len(base.pts) == 1 else ():
            if isinstance(index, ir.Slice) and not index.parts:
                self.empty(obj)
            elif known and obj.kind == "mapping" and self.content(obj) is BOTTOM:
                self.store.put((obj, item_field(key)), ABSENT)


def _answer(s: ir.Return) -> ir.Call:
    """Return the call that ROS makes of what a handler returns."""
    return ir.Call(ir.Const(None, s.pos), (), (), s.pos, 0)


EXECUTE: Mapping[type, Callable[..., bool]] = {
    ir.Assign: Execution._assignment,
    ir.Evaluate: Execution._expression,
    ir.If: Execution._if,
    ir.Loop: Execution.loop,
    ir.Try: Execution._try,
    ir.With: Execution._with,
    ir.Return: Execution._returned,
    ir.Raise: Execution._raised,
    ir.Jump: Execution._jump,
    ir.Define: Execution.define,
    ir.Class: Execution.define_class,
    ir.Import: Execution.import_names,
    ir.Delete: Execution._delete,
}
