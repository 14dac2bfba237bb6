"""Functions, classes and imports: statements that define names."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.branches import Branches
from tarl_lint.valueflow.control import control_dependence
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.states import LATER
from tarl_lint.valueflow.values import ClassInfo, Obj, Value, lineage, pointer


class Defining(Branches):
    """Executes definitions and imports."""

    def define(self, s: ir.Define, frame: Frame) -> bool:
        """Execute a `def`; a property's setter is kept beside the property."""
        value = self.closure(s.function, frame, "def")
        for decorator in s.function.decorators:
            if (
                isinstance(decorator, ir.Attribute)
                and decorator.name == "setter"
                and isinstance(s.target, ir.Name)
            ):
                self.setters.add(s.target.name)
                self.store.put((self.holder(s.target, frame), f"{s.target.name}.setter"), value)
                return True
        self.assign(s.target, self.decorated(value, s.function.decorators, s, frame), frame)
        return True

    def decorated(self, value: Value, decorators: Sequence[ir.Expr], s: ir.Stmt, frame: Frame) -> Value:
        """Return what decorators of ours make of a function or class; those of libraries leave it as it is.

        One that is a method of a library's object, as `@server.route("/")`, hands it to that object, to be called.
        """
        for decorator in reversed(decorators):
            wrapper = self.evaluate(decorator, frame)
            maker = decorator.function if isinstance(decorator, ir.Call) else decorator
            if isinstance(maker, ir.Attribute) and self._of_library(self.evaluate(maker.base, frame)):
                for target in sorted((o for o in value.pts if o.kind in LATER), key=lambda o: o.number):
                    self.call_later(target, ())
            if any(self.wraps(o) for o in wrapper.pts):
                call = ir.Call(decorator, (), (), s.pos, -1)
                value = self.call_value(wrapper, ([value], {}), frame, call)
        frame.statement = s
        return value

    def _of_library(self, value: Value) -> bool:
        return bool(value.pts) and all(o.kind == "lib" for o in value.pts)

    def wraps(self, obj: Obj) -> bool:
        """Tell whether a decorator is one of ours; of classes those whose instances can be called."""
        if obj.kind == "class":
            return any(self.store.get((owner, "__call__")) is not None for owner in lineage(obj))
        return obj.kind in ("closure", "bound", "partial") or (
            obj.kind == "instance" and self.callable_held(obj)
        )

    def define_class(self, s: ir.Class, frame: Frame) -> bool:
        """Execute a class statement; tell that execution goes on."""
        self.run_class(s, frame)
        return True

    def run_class(self, statement: ir.Class, frame: Frame) -> None:
        """Execute a class statement: its body stores into the class."""
        cls = self.intern("class", (frame.id, statement.id), statement.name)
        info = ClassInfo(statement.name, statement.qualname, statement=statement, module=frame.program.name)
        info.fields = statement.fields
        for expr in statement.bases:
            value = self.evaluate(expr, frame)
            info.bases += sorted(
                (o for o in value.pts if o.kind == "class" and o is not cls), key=lambda o: str(o.key)
            )
            info.external += [
                o.name for o in value.pts if o.kind not in ("class",) and o.name != "builtins.object"
            ]
            if not value.pts:
                info.external.append("?")
        cls.info = info
        body = Frame(
            ("class", cls.key),
            self.frame_number(("class", cls.key)),
            frame.function,
            frame.program,
            frame.module,
        )
        body.cls, body.outer, body.base = cls, frame, self.branches(frame, statement)
        body.control = statement.control = statement.control or control_dependence(statement.body)
        body.caller, body.call = frame, statement
        body.depth_of_layers = frame.depth_of_layers
        self.block(statement.body, body)
        frame.statement = statement
        made = self.decorated(pointer(cls), statement.decorators, statement, frame)
        self.assign(statement.target, made if made.pts else pointer(cls), frame)

    def frame_number(self, key: object) -> int:
        """Return a frame's number, the same at every run."""
        return self.frame_numbers.setdefault(key, -2 - len(self.frame_numbers))

    def import_names(self, s: ir.Import, frame: Frame) -> bool:
        """Bind what is imported."""
        importer = self.modules[frame.program.path]
        for target, module, member in s.bindings:
            if member == "*":
                found = self.index.find(module, importer)
                star = found.name if found is not None else module
                if star not in frame.program.stars:
                    frame.program.stars.append(star)
            elif target is not None:
                self.assign(target, self.imported(module, member, importer), frame)
        return True

    def imported(self, module: str, member: str | None, importer: object) -> Value:
        """Return what an import binds: a module of ours, a name in one, or something of a library."""
        raise NotImplementedError
