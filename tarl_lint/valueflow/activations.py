"""Calls of analysed functions and classes: arguments go in, results and the changed state come out."""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.bounds import ALL_LEISURE, LEISURE, MANY, MAX_CALLS, MAX_FRAMES, OFTEN
from tarl_lint.valueflow.evaluate import Evaluation
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import item_field
from tarl_lint.valueflow.invocation import Arguments
from tarl_lint.valueflow.leftovers import lasting
from tarl_lint.valueflow.store import BORN
from tarl_lint.valueflow.values import BOTTOM, NONE, UNKNOWN, Nodes, Obj, Value, join, lineage, pointer

CALLABLE = frozenset(["closure", "bound", "class", "ext", "partial", "method", "weak"])
ROOT_CALL = ir.Call(ir.Const(None, (0, 0, 0, 0)), (), (), (0, 0, 0, 0), 0)


class Activations(Evaluation):
    """Runs functions and makes instances."""

    def all_used(self, arguments: Arguments) -> Nodes:
        """Return the nodes of all data among the arguments."""
        plain, named = arguments
        deps = NONE
        for value in (*plain, *named.values()):
            deps |= self.use(value)
        return deps

    def make_frame(
        self, closure: Obj, caller: Frame, call: ir.Call, receiver: Hashable, owner: Obj | None
    ) -> Frame | None:
        """Return the activation for this call, None when it would be one too many."""
        if not isinstance(closure.info, tuple):
            return None
        function, outer, program, cls = closure.info
        runs = self.activations[function] = self.activations.get(function, 0) + 1
        if len(self.stack) > MAX_CALLS or [f.function for f in self.stack].count(function) > 1:
            return None
        if self.spent > self.limit or (self.spent > MANY and runs > OFTEN):
            self.cut[self.program] = None
            return None
        statement = caller.statement.id if caller.statement is not None else -1
        key = (caller.id, statement, call.slot, closure.key, receiver, *caller.turn)
        frame = self.frames.get(key)
        if frame is None:
            made = self.frames_of[self.program] = self.frames_of.get(self.program, 0) + 1
            if made > MAX_FRAMES:
                self.cut[self.program] = None
                return None
            frame = Frame(key, len(self.frames) + 1, function, program, self.module_objects[program.name])
            self.frames[key] = frame
            frame.caller, frame.call, frame.slot, frame.outer = caller, caller.statement, call.slot, outer
            frame.base = self.branches(caller, caller.statement) | frozenset(self.guards)
            frame.call_pos = call.pos
            frame.owner = owner or cls
            frame.answer = caller.answer if caller.statement is None and caller.caller is None else None
        return frame

    def invoke(
        self, closure: Obj, arguments: Arguments, caller: Frame, call: ir.Call, owner: Obj | None = None
    ) -> Value:
        """Run a function on arguments; where no data goes in and nothing takes part, only so far."""
        before, start = self.leisure, self.spent
        matters = not isinstance(closure.info, tuple) or closure.info[2].takes_part or carries(arguments)
        if not matters and before is not None and start > before:
            return self._again(closure, arguments)
        if matters:
            self.leisure = None
        elif before is None:
            self.leisure = start + max(0, min(LEISURE, ALL_LEISURE - self.idled))
        result = self._invoke(closure, arguments, caller, call, owner)
        if not matters and before is None:
            self.idled += self.spent - start
        self.leisure = before + self.spent - start if matters and before is not None else before
        return result

    def _invoke(
        self, closure: Obj, arguments: Arguments, caller: Frame, call: ir.Call, owner: Obj | None
    ) -> Value:
        receiver = arguments[0][0].pts if owner is not None and arguments[0] else None
        frame = self.make_frame(closure, caller, call, receiver, owner)
        if frame is None:
            return self._again(closure, arguments)
        self.called.add((frame.function.module, frame.function.pos[0]))
        passed = self.pass_arguments(arguments, caller, call)
        self.store.push()
        depth = len(self.store.layers) - 1
        frame.depth_of_layers = depth
        frame.root_waits = caller.root_waits
        frame.jumps, frame.tries, frame.escapes = [], [], []
        self.bind_parameters(frame, closure, passed)
        self._note_arguments(frame, arguments, caller, call)
        frame.guards |= frozenset(self.guards)
        self.guards, guards = [], self.guards
        self.stack.append(frame)
        result = self.run(frame)
        self.stack.pop()
        self.guards = guards
        self.note_result(call, [v for _, v in frame.returns], frame)
        if frame.escapes:
            self.escaped(frame, caller)
        self.store.cut(depth)
        self.merge([lasting(d, frame, _handed(frame, v), self.given) for d, v in frame.returns] or [{}])
        if frame.function.generator:
            collected = self.allocate("sequence", caller, ("generator", call.slot))
            self.add_element(pointer(collected), frame.yielded)
            return pointer(collected)
        return result

    def escaped(self, frame: Frame, caller: Frame) -> None:
        """Let what comes after a call depend on whether the called function raises."""
        raise NotImplementedError

    def _again(self, closure: Obj, arguments: Arguments) -> Value:
        """Return the result of a recursive call: what is known by now, and data of the arguments."""
        known = BOTTOM
        for frame in self.stack:
            if frame.key[3] == closure.key if isinstance(frame.key, tuple) and len(frame.key) > 3 else False:
                known = join(known, frame.result)
        return join(known, Value(self.all_used(arguments)))

    def pass_arguments(self, arguments: Arguments, caller: Frame, call: ir.Call) -> Arguments:
        """Let each argument pass through the calling statement."""
        plain, named = arguments
        shift = len(plain) - len(call.arguments)
        passed: list[Value] = []
        for number, value in enumerate(plain):
            if _receiver(value) or caller.statement is None:
                passed.append(value)
                continue
            node = self.node(caller, ("argument", call.slot, number), "call")
            if 0 <= number - shift < len(call.arguments):
                self.mark(node, call.arguments[number - shift], value, caller)
            passed.append(self.carry(value, node))
        keywords = dict(call.keywords)
        renamed: dict[str, Value] = {}
        for name, value in named.items():
            if caller.statement is None:
                renamed[name] = value
                continue
            node = self.node(caller, ("argument", call.slot, name), "call")
            if name in keywords:
                self.mark(node, keywords[name], value, caller)
            renamed[name] = self.carry(value, node)
        return passed, renamed

    def _note_arguments(self, frame: Frame, arguments: Arguments, caller: Frame, call: ir.Call) -> None:
        """Remember which parameters hold what is None only as long as nothing has come."""
        plain, named = arguments
        if caller.statement is None or any(isinstance(a, ir.Starred) for a in call.arguments):
            return
        shift = len(plain) - len(call.arguments)
        for parameter, value, expr in zip(
            frame.function.parameters[shift:], plain[shift:], call.arguments, strict=False
        ):
            self.note_passed((frame, parameter.name), expr, value, caller)
        for name, expr in call.keywords:
            if name is not None and name in named:
                self.note_passed((frame, name), expr, named[name], caller)

    def bind_parameters(self, frame: Frame, closure: Obj, arguments: Arguments) -> None:
        """Store arguments under the parameters' names."""
        plain, named = list(arguments[0]), dict(arguments[1])
        rest, mapping = named.pop("*", None), named.pop("**", None)
        frame.arguments = [*plain, *named.values()]
        for parameter in frame.function.parameters:
            if parameter.kind == "star":
                obj = self.allocate("sequence", frame, ("rest", parameter.name))
                for number, value in enumerate(plain):
                    self.store.put((obj, item_field(number)), value)
                if rest is not None:
                    self.add_element(pointer(obj), rest)
                value, plain = pointer(obj), []
            elif parameter.kind == "mapping":
                obj = self.allocate("mapping", frame, ("rest", parameter.name))
                for name, value in named.items():
                    self.store.put((obj, item_field(name)), value)
                if mapping is not None:
                    self.absorb(obj, mapping)
                value, named = pointer(obj), {}
            elif parameter.kind == "plain" and plain:
                value = plain.pop(0)
            elif parameter.name in named:
                value = named.pop(parameter.name)
            else:
                value = self._missing(parameter, closure, rest, mapping)
            self.store.put((frame, parameter.name), value)

    def _missing(
        self, parameter: ir.Parameter, closure: Obj, rest: Value | None, mapping: Value | None
    ) -> Value:
        """Return what a parameter is that no argument names."""
        value = self.store.get((closure, parameter.name)) if parameter.default is not None else None
        result = BOTTOM if value is None else value
        if rest is not None and parameter.kind == "plain":
            result = join(result, rest)
        if mapping is not None:
            for obj in mapping.pts:
                stored = self.store.get((obj, item_field(parameter.name)))
                result = join(result, self.arrive(stored or self.content(obj), mapping.deps))
        return result if result is not BOTTOM else UNKNOWN

    def instantiate(self, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Make an instance, by its own `__new__` if it has one, and run its `__init__`."""
        self.made.add(cls.key)
        for owner in lineage(cls):
            new = self.store.get((owner, "__new__"))
            if new is not None:
                plain, named = arguments
                made = self.call_value(new, ([pointer(cls), *plain], named), frame, call)
                for obj in sorted(made.pts, key=lambda o: o.number):
                    if obj.kind == "instance" and obj.info is cls:
                        self._initialise(obj, cls, arguments, frame, call)
                return made
        obj = self.blank_instance(cls, frame, call)
        self._initialise(obj, cls, arguments, frame, call)
        return pointer(obj)

    def blank_instance(self, cls: Obj, frame: Frame, call: ir.Call) -> Obj:
        """Return an instance as `object.__new__` makes it."""
        statement = frame.statement.id if frame.statement is not None else -1
        obj = self.intern("instance", (frame.id, statement, call.slot, cls.key, *frame.turn), cls.name)
        obj.info = cls
        self.store.put((obj, BORN), BOTTOM)
        return obj

    def _initialise(self, obj: Obj, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
        for owner in lineage(cls):
            init = self.store.get((owner, "__init__"))
            if init is not None:
                self.call_value(self.bind(init, obj, owner), arguments, frame, call)
                break
        else:
            self._fill(obj, cls, arguments, frame, call)
        self.instance_made(obj, cls, frame)

    def _fill(self, obj: Obj, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
        """Store the arguments as a dataclass or named tuple does."""
        raise NotImplementedError

    def instance_made(self, obj: Obj, cls: Obj, frame: Frame) -> None:
        """Tell who runs methods of such objects on their own (threads)."""


def _handed(frame: Frame, returned: Value) -> list[Obj]:
    """Return the objects that a function hands out by other ways than by storing them."""
    raised = (o for escape in frame.escapes for o in escape.value.pts)
    return [*returned.pts, *frame.yielded.pts, *raised]


def carries(arguments: Arguments) -> bool:
    """Tell whether any data is in what is passed."""
    plain, named = arguments
    return any(v.deps or any(o.laden for o in v.pts) for v in (*plain, *named.values()))


def _receiver(value: Value) -> bool:
    """Tell whether an argument is an object of ours, which needs no node to be followed."""
    return bool(value.pts) and not value.deps and all(o.kind in ("instance", "class") for o in value.pts)
