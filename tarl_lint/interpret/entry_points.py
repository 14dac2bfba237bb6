"""Entry points: main functions, node classes, and methods that a framework calls."""

from __future__ import annotations

from collections.abc import Set

from tarl_lint import catalog
from tarl_lint.interpret import annotated, calls
from tarl_lint.interpret.call_contexts import ROOT_CALL
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.node_starts import STARTING, definitions, publishes, registers, starts_node
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency, userdata
from tarl_lint.memory.shared import Root
from tarl_lint.memory.values import ClassInfo, Obj, lineage
from tarl_lint.models import states_and_behaviours
from tarl_lint.models.ros import subscriptions


def start_functions(ctx: Interpreter) -> None:
    """Run the main functions that nothing in the files calls, and the functions that a decorator hands over."""
    for program, module in _analysed(ctx):
        starting = ctx.modules[program.path].matches(STARTING)
        named = ctx.modules[program.path].started
        for statement in definitions(program.body):
            if not isinstance(statement, ir.Define):
                continue
            function = statement.function
            if function.name in named or ((starting or function.name == "main") and starts_node(function)):
                _main_function(ctx, statement, module)
    _handed_over(ctx)


def start_classes(ctx: Interpreter) -> None:
    """Instantiate plugins, and the node classes that nothing in the files instantiates.

    The main functions must have run before, because they instantiate node classes with arguments that are unknown here.
    """
    for program, module in _analysed(ctx):
        starting = ctx.modules[program.path].matches(STARTING)
        named = ctx.modules[program.path].started
        for statement in definitions(program.body):
            if isinstance(statement, ir.Define):
                continue
            if statement.name in named:
                _plugin(ctx, statement, module)
            else:
                _node_class(ctx, statement, program, starting)


def _analysed(ctx: Interpreter) -> list[tuple[ir.Program, Obj]]:
    """Return the programs of the analysed files with their modules, without installed packages."""
    return [
        (program, ctx.module_objects[program.name])
        for program in ctx.programs.values()
        if not ctx.modules[program.path].installed
    ]


def _handed_over(ctx: Interpreter) -> None:
    """Run the functions that a package outside the files may call, because its decorator registered them."""
    for target in sorted(ctx.handed_over, key=lambda o: str(o.key)):
        if target.kind != "closure" or not isinstance(target.info, tuple):
            continue
        function, _, program, owner = target.info
        if owner is None and (function.module, function.pos[0]) not in ctx.called:
            subscriptions.call_when(ctx, "framework", target, [], "callback", program=program.path)


def _main_function(ctx: Interpreter, statement: ir.Define, module: Obj) -> None:
    function = statement.function
    if (function.module, function.pos[0]) in ctx.called:
        return
    for obj in _values(ctx, module, function.name):
        if obj.kind == "closure":
            _start(ctx, obj, "main", ctx.programs[module.name].path)


def _values(ctx: Interpreter, holder: Obj, name: str) -> list[Obj]:
    owners = ctx.shared.ends.get((holder, name), {})
    return sorted({o for v in owners.values() for o in v.pts}, key=lambda o: str(o.key))


def _start(ctx: Interpreter, target: Obj, kind: str, path: str) -> None:
    root = Root((kind, target.kind, target.key), kind, target.name, once=True, program=path)

    def run(root: Root) -> None:
        calls.call_object(ctx, target, ([], {}), ctx.ops.root_frame(ctx, root), ROOT_CALL)

    ctx.ops.add_root(ctx, root, run)


def _plugin(ctx: Interpreter, statement: ir.Class, module: Obj) -> None:
    """Instantiate a class that a package declares as plugin."""
    for cls in _values(ctx, module, statement.name):
        if cls.kind == "class" and (cls in ctx.plugins or cls.key not in ctx.made):
            _start(ctx, cls, "node", ctx.programs[module.name].path)
            ctx.plugins.add(cls)


def _node_class(ctx: Interpreter, statement: ir.Class, program: ir.Program, starting: bool) -> None:
    """Instantiate a class that registers something or is a node. Skip a class that the files instantiate."""
    for cls in _values(ctx, ctx.module_objects[program.name], statement.name):
        if cls.kind != "class" or cls.key in ctx.made:
            continue
        if starting and registers(statement):
            wanted = not _has_made_heir(ctx, cls)
        elif _passed_by_others(ctx, cls, statement, ctx.module_objects[program.name]):
            wanted = True
        else:
            tests = starting and ctx.modules[program.path].contains(".publish(")
            wanted = _last_node(ctx, cls, catalog.NODES | (catalog.TESTS if tests else frozenset()))
        if wanted:
            _start(ctx, cls, "node", program.path)
            ctx.guests.add(cls)


def _passed_by_others(ctx: Interpreter, cls: Obj, statement: ir.Class, module: Obj) -> bool:
    """Return whether other code may pass on objects of a class, or pass objects to it.

    Other code is code outside the files. If a class annotates a parameter, other code is assumed to pass objects of
    this class or of its most derived subclasses. It may also pass objects of the analysed files to the constructor
    of a class that publishes or has a timer.
    """
    if not ctx.wanted.isdisjoint(lineage(cls)):
        return not any(o.kind == "class" and o is not cls and cls in lineage(o) for o in ctx.objects.values())
    inits = (
        s.function
        for s in definitions(statement.body)
        if isinstance(s, ir.Define) and s.function.name == "__init__"
    )
    return any(publishes(f) and annotated.classes_of_parameters(ctx, f, module) for f in inits)


def _last_node(ctx: Interpreter, cls: Obj, bases: Set[str]) -> bool:
    """Return whether a class without subclasses inherits from one of these library classes."""
    if not isinstance(cls.info, ClassInfo) or _external(cls.info).isdisjoint(bases):
        return False
    return not any(o.kind == "class" and o is not cls and cls in lineage(o) for o in ctx.objects.values())


def _has_made_heir(ctx: Interpreter, cls: Obj) -> bool:
    return any(cls in lineage(ctx.objects["class", key]) for key in ctx.made)


def start_hooks(ctx: Interpreter) -> None:
    """Run methods that a library's base class may call at any time."""
    for obj in list(ctx.objects.values()):
        if obj.kind != "instance" or not isinstance(obj.info, Obj):
            continue
        for owner in lineage(obj.info):
            if isinstance(owner.info, ClassInfo) and owner.info.statement is not None:
                _framework_methods(ctx, obj, owner, owner.info)


def _framework_methods(ctx: Interpreter, obj: Obj, owner: Obj, info: ClassInfo) -> None:
    cls = obj.info.info if isinstance(obj.info, Obj) else None
    external = _external(cls) if isinstance(cls, ClassInfo) else set()
    unknown = external - catalog.NODE_BASES or _called_by_others(ctx, obj)
    for statement in definitions(info.statement.body) if info.statement is not None else ():
        if not isinstance(statement, ir.Define):
            continue
        name, function = statement.function.name, statement.function
        hooked = (unknown and not name.startswith("_")) or (external and name.startswith("on_"))
        hooked = hooked or (name == "run" and any("Thread" in e for e in external))
        if not (hooked or function.decorators) or (function.module, function.pos[0]) in ctx.called:
            continue
        for closure in _values(ctx, owner, name):
            if closure.kind == "closure" and (hooked or closure in ctx.handed_over):
                _start_method(ctx, closure, obj, owner, external)


def _called_by_others(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether code outside the analysed files makes objects of this class and calls their methods."""
    return obj.info in ctx.plugins or obj.info in ctx.guests


def _start_method(ctx: Interpreter, closure: Obj, obj: Obj, owner: Obj, external: Set[str]) -> None:
    state = closure.name == catalog.RUNS_STATE and any(e.startswith(catalog.STATES) for e in external)
    given = [userdata.userdata(ctx, obj)] if state else []
    guards, answer = states_and_behaviours.run_by_others(ctx, obj, closure, external)
    method = recency.intern(ctx, "bound", (closure.key, obj), closure.name)
    method.info = (closure, obj, owner)
    program = closure.info[2].path if isinstance(closure.info, tuple) else ""
    subscriptions.call_when(
        ctx, "framework", method, given, "callback", program=program, guards=guards, answer=answer
    )


def _external(info: ClassInfo) -> set[str]:
    found = set(info.external)
    for base in info.bases:
        if isinstance(base.info, ClassInfo):
            found |= _external(base.info)
    return found
