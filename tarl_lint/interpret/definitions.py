"""Transfer functions of definitions: functions, classes, imports."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint import catalog
from tarl_lint.interpret import calls, descriptors, expressions, metaclasses, single_dispatch
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import control_dependence
from tarl_lint.memory import enumerations, heap, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.function_attributes import DECORATED, attribute_of
from tarl_lint.memory.values import ClassInfo, Obj, Value, const, function_of, join, lineage, pointer
from tarl_lint.models.ros import subscriptions
from tarl_lint.models.smach import LATER
from tarl_lint.read.module_names import KNOWN


def define(ctx: Interpreter, s: ir.Define, frame: Frame) -> bool:
    """Execute a `def`; a property's setter is stored beside the property."""
    value = expressions.closure(ctx, s.function, frame, "def")
    for decorator in s.function.decorators:
        if (
            isinstance(decorator, ir.Attribute)
            and decorator.name == "setter"
            and isinstance(s.target, ir.Name)
        ):
            ctx.nullness.setters.add(s.target.name)
            ctx.store.put((expressions.holder(s.target, frame), f"{s.target.name}.setter"), value)
            return True
    if frame.owner_class() is not None:
        descriptors.note(ctx, s.function.name)
    made = decorated(ctx, value, s.function.decorators, s, frame)
    ctx.ops.assign(ctx, s.target, made, frame)
    for decorator in s.function.decorators:
        _add_implementation(ctx, decorator, made, frame)
    return True


def _add_implementation(ctx: Interpreter, decorator: ir.Expr, made: Value, frame: Frame) -> None:
    """Add the implementation that `@function.register` gives a function with `singledispatch`."""
    maker = decorator.function if isinstance(decorator, ir.Call) else decorator
    if not isinstance(maker, ir.Attribute) or maker.name != "register":
        return
    general = expressions.evaluate(ctx, maker.base, frame)
    functions = [f for o in general.pts if (f := function_of(o)) is not None]
    if any(_last_name(d).startswith("singledispatch") for f in functions for d in f.decorators):
        given = [expressions.evaluate(ctx, one, frame) for one in getattr(decorator, "arguments", ())]
        single_dispatch.note(ctx, decorator, given, made)
        ctx.ops.assign(ctx, maker.base, join(general, made), frame)


def _last_name(expr: ir.Expr) -> str:
    return expr.name if isinstance(expr, (ir.Name, ir.Attribute)) else ""


def decorated(
    ctx: Interpreter, value: Value, decorators: Sequence[ir.Expr], s: ir.Stmt, frame: Frame
) -> Value:
    """Apply analysed decorators to a function or class; library decorators leave it unchanged.

    A decorator that is a method of a library object, such as `@server.route("/")`, registers the function with it. A
    decorator of an unknown package, such as `@tool`, may register it too; this matters only if no file calls it.
    """
    for decorator in reversed(decorators):
        wrapper = expressions.evaluate(ctx, decorator, frame)
        maker = decorator.function if isinstance(decorator, ir.Call) else decorator
        package = expressions.evaluate(ctx, maker, frame) if isinstance(decorator, ir.Call) else wrapper
        later = [o for o in value.objects if o.kind in LATER]
        if isinstance(maker, ir.Attribute) and _of_library(expressions.evaluate(ctx, maker.base, frame)):
            for target in later:
                subscriptions.call_later(ctx, target, ())
        elif later and _of_unknown_package(package):
            ctx.handed_over.update(later)
        if any(wraps(ctx, o) for o in wrapper.pts):
            call = ir.Call(decorator, (), (), s.pos, -1)
            value = calls.call_value(ctx, wrapper, ([value], {}), frame, call)
        elif not ctx.nothing_yet(wrapper) and not _of_known_package(package):
            _note_library(ctx, later)
    frame.statement = s
    return value


def _of_library(value: Value) -> bool:
    return bool(value.pts) and all(o.kind == "lib" for o in value.pts)


def _of_unknown_package(value: Value) -> bool:
    packages = {o.name.partition(".")[0] for o in value.pts if o.kind == "ext"}
    return bool(packages) and packages.isdisjoint(KNOWN | catalog.TRANSFORMS)


def _of_known_package(value: Value) -> bool:
    """Return whether a value is a name of the standard library or of ROS."""
    return bool(value.pts) and all(o.kind == "ext" and o.name.partition(".")[0] in KNOWN for o in value.pts)


def _note_library(ctx: Interpreter, functions: Sequence[Obj]) -> None:
    """Note that a decorator of a library, or an unknown decorator, may have added attributes to functions."""
    for one in functions:
        if one.kind == "closure":
            ctx.store.put((one, attribute_of(DECORATED)), const(value=True))


def wraps(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether a decorator is an analysed function, an instance with `__call__`, or a class of such instances."""
    if obj.kind == "class":
        return any(ctx.store.get((owner, "__call__")) is not None for owner in lineage(obj))
    return obj.kind in ("closure", "bound", "partial") or (
        obj.kind == "instance" and calls.callable_held(ctx, obj)
    )


def define_class(ctx: Interpreter, s: ir.Class, frame: Frame) -> bool:
    """Execute a class statement; return True, since execution continues."""
    run_class(ctx, s, frame)
    return True


def run_class(ctx: Interpreter, statement: ir.Class, frame: Frame) -> None:
    """Execute a class statement, whose body stores into the class."""
    cls = recency.intern(ctx, "class", (frame.id, statement.id), statement.name)
    info = ClassInfo(statement.name, statement.qualname, statement=statement, module=frame.program.name)
    info.fields = statement.fields
    for expr in statement.bases:
        value = expressions.evaluate(ctx, expr, frame)
        info.bases += sorted(
            (o for o in value.pts if o.kind == "class" and o is not cls), key=lambda o: str(o.key)
        )
        info.external += [
            o.name for o in value.pts if o.kind not in ("class",) and o.name != "builtins.object"
        ]
        if not value.pts:
            info.external.append("?")
    ctx.shared.edition += isinstance(cls.info, ClassInfo) and _inherits(cls.info) != _inherits(info)
    cls.info = info
    given = expressions.evaluate(ctx, statement.metaclass, frame) if statement.metaclass is not None else None
    body = Frame(
        ("class", cls.key),
        frame_number(ctx, ("class", cls.key)),
        frame.function,
        frame.program,
        frame.module,
    )
    body.cls, body.outer, body.base = cls, frame, ctx.branches(frame, statement)
    body.control = statement.control = statement.control or control_dependence(
        statement.body, types=ctx.exception_types
    )
    body.caller, body.call = frame, statement
    body.depth_of_layers = frame.depth_of_layers
    ctx.ops.block(ctx, statement.body, body)
    frame.statement = statement
    if enumerations.enumerates(cls):
        _make_members(ctx, cls, statement, frame)
    descriptors.name_all(ctx, cls, frame, statement.pos)
    _subclassed(ctx, cls, statement, frame)
    info.metaclass = metaclasses.of(cls, given)
    if info.metaclass is not None:
        metaclasses.apply(ctx, cls, info.metaclass, frame, statement.pos)
    made = decorated(ctx, pointer(cls), statement.decorators, statement, frame)
    ctx.ops.assign(ctx, statement.target, made if made.pts else pointer(cls), frame)


def _make_members(ctx: Interpreter, cls: Obj, statement: ir.Class, frame: Frame) -> None:
    """Call `__init__` for each marked member of an enumeration."""
    for number, (member, elements) in enumerate(enumerations.mark(ctx, cls)):
        init = heap.through_class(ctx, member, cls, "__init__")
        if init is not None:
            call = ir.Call(ir.Const(None, statement.pos), (), (), statement.pos, -1 - number)
            ctx.ops.call_value(ctx, init, (elements, {}), frame, call)


def _subclassed(ctx: Interpreter, cls: Obj, statement: ir.Class, frame: Frame) -> None:
    """Call the `__init_subclass__` of the first base class that has one, because this method may register the class."""
    for base in lineage(cls)[1:]:
        hook = ctx.store.get((base, "__init_subclass__"))
        if hook is not None:
            call = ir.Call(ir.Const(None, statement.pos), (), (), statement.pos, -1)
            named = {n: expressions.evaluate(ctx, value, frame) for n, value in statement.keywords}
            calls.call_value(ctx, hook, ([pointer(cls)], named), frame, call)
            return


def _inherits(info: ClassInfo) -> tuple[list[Obj], list[str]]:
    return info.bases, info.external


def frame_number(ctx: Interpreter, key: object) -> int:
    """Return a number for a frame; the number is the same in every run."""
    return ctx.frame_numbers.setdefault(key, -2 - len(ctx.frame_numbers))


def import_names(ctx: Interpreter, s: ir.Import, frame: Frame) -> bool:
    """Bind the imported names."""
    importer = ctx.modules[frame.program.path]
    for target, module, member in s.bindings:
        if member == "*":
            found = ctx.index.find(module, importer)
            if found is not None:
                ctx.note_import(found, importer)
            star = found.name if found is not None else module
            if star not in frame.program.stars:
                frame.program.stars.append(star)
                ctx.shared.edition += 1
        elif target is not None:
            ctx.ops.assign(ctx, target, ctx.ops.imported(ctx, module, member, importer), frame)
    return True
