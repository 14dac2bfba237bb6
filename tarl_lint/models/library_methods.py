"""Calls of methods of objects whose class is not analysed: the object may change, and callbacks may run."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, library_instances, message_types, updates
from tarl_lint.memory.blackboards import CLIENT
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import (
    NONE,
    UNKNOWN,
    Nodes,
    Obj,
    Value,
    inherited_from,
)
from tarl_lint.method_effects import changes, derives, fails, keeps_callables, observes, returns_all
from tarl_lint.models import (
    argument_parsers,
    behaviour_trees,
    blackboards,
    callables,
    containers,
    drawings,
    environment,
    files_by_path,
    filling,
    fixed_numbers,
    logging_handlers,
    objects,
    qt_signals,
    reflection,
    smach,
    strings,
    waiting,
)
from tarl_lint.models.containers import is_device
from tarl_lint.models.futures import READERS
from tarl_lint.models.library_functions import dropped, new_object
from tarl_lint.models.ros import behaviour_subscribers, senders
from tarl_lint.models.smach import LATER
from tarl_lint.models.strings import TEXT_METHODS

# methods of events and conditions, without arguments
SIGNALS: Final = {"wait": waiting.wait_for_flag, "notify": containers.flag, "notify_all": containers.flag}
# method of base classes that are not analysed → kinds of objects on which it is called
OF_BASE: Final = {
    **dict.fromkeys(("__new__", "__init__"), ("super", "class")),
    "__setattr__": ("super", "class", "instance"),
}
SIGNALLING = frozenset(["connect", "emit"])


def call_method(
    ctx: Interpreter,
    base: Value,
    target: Obj | None,
    name: str,
    arguments: Arguments,
    frame: Frame,
    call: ir.Call,
) -> Value:
    """Call a method of an object whose class is not analysed."""
    if ctx.following_clients and target is not None:
        client = ctx.ops.launched_call(ctx, target, Invocation(name, base, arguments, frame, call))
        if client is not None:
            return client
    known = catalog.CLASS_METHODS.get(f"{target.name}.{name}") if target is not None and target.name else None
    if known is None and name == "transform" and not catalog.BUFFERS.isdisjoint(inherited_from(base)):
        known = catalog.TRANSFORM
    if known is not None:
        return ctx.ops.ros_call(ctx, Invocation(name, base, arguments, frame, call, known))
    if target is not None and (part := _of_kind(ctx, target, Invocation(name, base, arguments, frame, call))):
        return part
    if name == "split" and ctx.exact and (parts := strings.pieces(ctx, base, arguments, frame, call)):
        return parts
    return _call_method(ctx, base, target, name, arguments, frame, call)


def _of_kind(ctx: Interpreter, target: Obj, it: Invocation) -> Value | None:
    """Call a method of a message, blackboard client or logger, or one adding a part; else None."""
    if it.name == "get_fields_and_field_types" and target.kind in message_types.KINDS:
        return reflection.fields_and_types(ctx, it)
    if it.name == "wait_for":
        return waiting.wait_for_condition(ctx, it)
    if target.kind == CLIENT:
        return blackboards.call(ctx, target, it)
    if it.name == blackboards.ATTACHES and target.kind == "instance":
        return blackboards.new_client(ctx, it)
    if behaviour_trees.adds(ctx, target, it.name):
        return behaviour_trees.add(ctx, target, it)
    if it.name in smach.ADDS and smach.holds_states(ctx, target):
        return smach.call(ctx, target, it)
    return logging_handlers.call(ctx, target, it)


def _call_method(
    ctx: Interpreter,
    base: Value,
    target: Obj | None,
    name: str,
    arguments: Arguments,
    frame: Frame,
    call: ir.Call,
) -> Value:
    kind = target.kind if target is not None else ""
    if target is not None and kind == "lib" and f"{target.name}.{name}" in ctx.config.named:
        return ctx.ops.call_library(ctx, f"{target.name}.{name}", arguments, frame, call)
    if target is not None and kind in OF_BASE.get(name, ()):
        return _built_by_base(ctx, target, Invocation(name, base, arguments, frame, call))
    if target is not None and name == "publish" and (sender := senders.sender(ctx, target)) is not None:
        return ctx.ops.send(ctx, Invocation(name, base, arguments, frame, call), sender)
    if target is not None and kind in ("server", "goal"):
        return ctx.ops.serve(ctx, target, Invocation(name, base, arguments, frame, call))
    if kind in ("filter", "synchronizer") and (name == "registerCallback" or name in catalog.CACHE_READERS):
        return ctx.ops.register_filter(ctx, target, Invocation(name, base, arguments, frame, call))
    if kind == "parameter":
        return base if name == "get_parameter_value" else UNKNOWN
    fact = catalog.METHODS.get(name)
    if fact is not None and kind not in ("sequence", "mapping"):
        return ctx.ops.ros_call(ctx, Invocation(name, base, arguments, frame, call, fact))
    if name in catalog.LOGGING or name in catalog.CLOCKS:
        return UNKNOWN
    if name in catalog.WAITING_METHODS or name in SIGNALS:
        _wait(ctx, Invocation(name, base, arguments, frame, call))
    if name in catalog.MUTATORS and not base.consts:
        return _store(ctx, target, Invocation(name, base, arguments, frame, call))
    if name in READERS and base.pts:
        return READERS[name](ctx, Invocation(name, base, arguments, frame, call))
    return _unknown_method(ctx, base, name, arguments, frame, call)


def _wait(ctx: Interpreter, it: Invocation) -> None:
    """Wait for other threads, or wake up another thread."""
    if it.name in catalog.WAITING_METHODS and not it.base.consts:
        ctx.ops.wait(ctx, it.frame)
    if it.name in SIGNALS and not any(it.arguments) and any(o.kind == "lib" for o in it.base.pts):
        SIGNALS[it.name](ctx, it)


def _store(ctx: Interpreter, target: Obj | None, it: Invocation) -> Value:
    """Store arguments in an object.

    An object of a library may also call the arguments, for example callbacks for a marker. It may return a result,
    as the `update` of a controller does.
    """
    kind = target.kind if target is not None else ""
    if kind == "lib":
        callables.call_back(ctx, it.arguments, it.frame, it.call)
    if it.name == "send" and target is not None and target.name == heap.GENERATOR:
        containers.sent(ctx, target, it)
        return heap.arrive(ctx, heap.read_any(ctx, target), it.base.deps)
    if filling.writes_itself(ctx, it):
        filling.fill(ctx, it, dropped=True)
        return UNKNOWN
    if kind == "lib":
        filling.pass_on(ctx, it)
    containers.mutate(ctx, it.base, it.name, it.arguments, it.frame, it.call)
    given_back = it.name == "setdefault" or (it.name == "send" and kind == "sequence")
    if given_back and target is not None:
        if it.name == "setdefault" and it.arguments[0] and _has_entries(target):
            return ctx.ops.read_item(ctx, it.base, it.arguments[0][0])
        return heap.read_any(ctx, target)
    if kind in ("lib", "") and not dropped(it.frame, it.call):
        return Value(ctx.use(it.base) | call_contexts.all_used(ctx, it.arguments))
    return UNKNOWN


def _has_entries(target: Obj) -> bool:
    """Return whether an object stores values under keys; an instance stands for its `__dict__`, too."""
    return target.kind in ("mapping", "closure", "instance") or target.name == heap.NAMESPACE


def _unknown_method(
    ctx: Interpreter, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value:
    it = Invocation(name, base, arguments, frame, call)
    text = files_by_path.call_path(ctx, it) or _of_text(ctx, base, name, arguments, frame, call)
    if text is not None:
        return text
    if (drawing := drawings.drawn_into(ctx, base, arguments, frame, call)) is not None:
        return drawing
    if (found := library_instances.looked_up(ctx, name, (*arguments[0], *arguments[1].values()))).pts:
        return found
    if name == "join" and not base.pts:
        arguments = strings.keys_joined(ctx, arguments, frame, call)
    callables.call_back(ctx, arguments, frame, call)
    _connect(ctx, Invocation(name, base, arguments, frame, call))
    given = _given(ctx, base, name, arguments, frame, call)
    if (raises := fails(name)) is not None:
        ctx.ops.may_fail(ctx, ctx.use(base) | call_contexts.all_used(ctx, arguments), raises, frame)
    learnt = call_contexts.all_used(ctx, arguments) | given
    if learnt or any(o.kind in LATER for v in (*arguments[0], *arguments[1].values()) for o in v.pts):
        ctx.ended |= inherited_from(base)
    if learnt and base.pts and all(map(changeable, base.pts)) and changes(name, dropped=dropped(frame, call)):
        containers.insert_elements(ctx, base, [Value(learnt)], frame, call)
    written = catalog.METHODS_WRITING.get(name)
    it = Invocation(name, base, arguments, frame, call)
    if written is None:
        filling.fill(ctx, it, dropped=dropped(frame, call))
    filling.pass_on(ctx, it)
    if written is not None and written < len(arguments[0]):
        news = containers.through_statement(
            ctx, Value(ctx.use(base) | call_contexts.all_used(ctx, arguments)), frame, call
        )
        containers.change(ctx, arguments[0][written], news, call.arguments[written:], frame)
    if name in catalog.DEVICE_READERS and base.pts and all(map(is_device, base.pts)):
        deps = containers.received(ctx, base, arguments)
    else:
        deps = ctx.use(base) | call_contexts.all_used(ctx, arguments) | given | _fields(ctx, base, name)
    if not deps and not base.pts:
        return UNKNOWN
    made = new_object(ctx, arguments, deps, frame, call, fields=False)
    return _loaded(ctx, made, it)


def _of_text(
    ctx: Interpreter, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value | None:
    """Return the result of a method of known texts; None for other methods and objects."""
    if base.pts or not base.consts:
        return None
    if name in strings.TESTS:
        return strings.tested(base, name, arguments)
    if name not in TEXT_METHODS:
        return None
    if name == "join":
        arguments = strings.keys_joined(ctx, arguments, frame, call)
    return Value(
        ctx.use(base) | call_contexts.all_used(ctx, arguments),
        consts=strings.text_of(ctx, base, name, arguments),
    )


def _fields(ctx: Interpreter, base: Value, name: str) -> Nodes:
    """Return an instance's field data, if a library base class's method returns all fields."""
    found = NONE
    for obj in base.objects if returns_all(name) else ():
        if obj.kind == "instance":
            ctx.store.reads.look(obj)
            held = (ctx.store.get((obj, field)) for field in list(obj.fields) if field.isidentifier())
            found = found.union(*(ctx.use(value) for value in held if value is not None))
    return found


def _connect(ctx: Interpreter, it: Invocation) -> None:
    """Register observers, connect or emit a signal, or declare an option of the command line."""
    if observes(it.name) and it.base.pts and all(map(changeable, it.base.pts)):
        callables.notify(ctx, it.base, it.arguments, it.frame, it.call)
    if it.name in SIGNALLING:
        qt_signals.signal(ctx, it.base, it.name, it.arguments, it.frame, it.call)
    elif it.name == environment.ADDING:
        environment.option(ctx, it)


def _loaded(ctx: Interpreter, made: Value, it: Invocation) -> Value:
    """Return the result of a method: parsed options, data loaded from a file, or a stream derived from another."""
    if derives(it.name):  # data that the base object receives later is also in the result
        updates.add_element(ctx, made, Value(pts=frozenset(o for o in it.base.pts if o.kind == "lib")))
    if it.name not in argument_parsers.PARSING:
        return made
    if ctx.thorough:
        made = fixed_numbers.loaded(ctx, made, it.frame, it.call)
    return environment.options(ctx, it, made)


def _given(
    ctx: Interpreter, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Nodes:
    """Return the data in the results of a library object's callables, because the object's methods may call these."""
    new = callables.answering(ctx, arguments) if name not in SIGNALLING else []
    if keeps_callables(name):
        callables.hold(ctx, base.pts, new)
        return NONE
    return callables.returned(ctx, [*callables.held_by(ctx, base), *new], arguments, base, frame, call)


def _built_by_base(ctx: Interpreter, target: Obj, it: Invocation) -> Value:
    """Call `__new__`, `__init__` or `__setattr__` of a base class that is not analysed."""
    if it.name == "__new__":
        return objects.blank_object(ctx, it)
    if it.name == "__setattr__" and (isinstance(target.info, tuple) or target.kind == "instance"):
        plain, named = it.arguments
        of = target.info[1] if isinstance(target.info, tuple) else target
        given = [Value(it.base.deps, frozenset([of])), *plain]
        return reflection.set_attribute(ctx, replace(it, arguments=(given, named)))
    if isinstance(target.info, tuple):
        logging_handlers.note_level(ctx, target.info[1], it.arguments)
        senders.inherit(ctx, target.info[1], it.arguments, it.frame, it.call)
        behaviour_trees.inherit(ctx, target.info[1], it)
        behaviour_subscribers.inherit(ctx, target.info[1], it)
        callables.make_instances(
            ctx, it.arguments, Value(it.base.deps, frozenset([target.info[1]])), it.frame, it.call
        )
    return _unknown_method(ctx, it.base, it.name, it.arguments, it.frame, it.call)


def changeable(obj: Obj) -> bool:
    """Return whether an object's library methods may change it. Library methods of a node do not change the node."""
    return obj.kind == "lib" and not (isinstance(obj.key, tuple) and obj.key[:1] == ("inherited",))
