"""Calls of functions and classes of libraries: the result depends on all arguments without a better model."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from tarl_lint import catalog
from tarl_lint.catalog import Fact
from tarl_lint.interpret import call_contexts, dunder_methods
from tarl_lint.interpret.dunder_methods import FUNCTIONS
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, heap, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.message_types import MESSAGE_MODULE
from tarl_lint.memory.values import (
    BOTTOM,
    BY_CLASS,
    NONE,
    UNKNOWN,
    Obj,
    Value,
    closure_of,
    pointer,
)
from tarl_lint.method_effects import fails, keeps_callables
from tarl_lint.models import (
    behaviour_trees,
    blackboards,
    callables,
    certain_conversions,
    command_line,
    containers,
    drawings,
    element_trees,
    environment,
    files_by_path,
    filling,
    fixed_numbers,
    function_wrappers,
    futures,
    heaps,
    iterators,
    logging_handlers,
    objects,
    ordering,
    records,
    reflection,
    smach,
    state_callbacks,
    strings,
    type_queries,
)
from tarl_lint.models.containers import CONTAINERS, QUEUES
from tarl_lint.models.ros import senders
from tarl_lint.models.ros.endpoints import NAMESPACE, Publisher
from tarl_lint.settings.wrappers import facts


def call_library(
    ctx: Interpreter, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value:
    """Call a function or class of a library."""
    if qualified in ctx.config.sanitizers:
        return UNKNOWN
    if qualified in catalog.WAITS:
        ctx.ops.wait(ctx, frame)
    if qualified in ctx.config.sinks:
        return ctx.ops.send(
            ctx, Invocation(qualified, BOTTOM, arguments, frame, call), Publisher(api=qualified)
        )
    if ctx.following_clients:
        client = ctx.ops.launched_call(ctx, None, Invocation(qualified, BOTTOM, arguments, frame, call))
        if client is not None:
            return client
    fact = _configured(ctx, qualified) or catalog.fact(qualified)
    if fact is not None:
        return ctx.ops.ros_call(ctx, Invocation(qualified, BOTTOM, arguments, frame, call, fact))
    name = qualified.removeprefix("builtins.").removeprefix("collections.")
    if name in FUNCTIONS and arguments[0]:
        said = dunder_methods.special(ctx, arguments[0][0], f"__{name}__", arguments[0][1:], frame, call.pos)
        if said is not None:
            return said
    particular = BUILTIN.get(name)
    if particular is not None:
        found = particular(ctx, Invocation(name, BOTTOM, arguments, frame, call))
    elif (drawing := drawings.drawn(ctx, qualified, arguments, frame, call)) is not None:
        return drawing
    else:
        found = generic(ctx, qualified, arguments, frame, call)
    noted = fixed_numbers.noted(ctx, qualified, found, arguments, frame, call)
    return Value(noted.deps, noted.pts, found.consts) if found.replaceable() else noted


def _configured(ctx: Interpreter, qualified: str) -> Fact | None:
    """Apply the settings to a call of a function.

    If the settings declare the function as a source, a call with a callback subscribes.
    """
    if ctx.config.wrappers and (fact := facts(ctx.config.wrappers).get(qualified)):
        return fact
    if qualified not in ctx.config.sources:
        return None
    return Fact("configured", qualified, (0, "topic"), (1, "type"), (-1, "callback"))


def named_by_settings(ctx: Interpreter, target: Obj) -> str:
    """Return the qualified name of an analysed function or method that the settings mention; "" for others."""
    if not ctx.config.named:
        return ""
    closure = closure_of(target)
    if closure.kind != "closure" or not isinstance(closure.info, tuple):
        return ""
    function, _, program, _ = closure.info
    qualified = f"{program.name}.{function.qualname}"
    return qualified if qualified in ctx.config.named else ""


def generic(ctx: Interpreter, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
    """Make the result depend on all arguments; store into the argument that is written according to the catalog."""
    name = qualified.rpartition(".")[2]
    if (raises := fails(name)) is not None and not certain_conversions.certain(ctx, name, arguments, call):
        ctx.ops.may_fail(ctx, call_contexts.all_used(ctx, arguments), raises, frame)
    shaped = name in catalog.SHAPED and qualified not in ctx.config.named
    deps = call_contexts.all_used(ctx, (arguments[0][1:], arguments[1]) if shaped else arguments)
    held = callables.answering(ctx, arguments) if qualified not in catalog.KEEPERS else []
    if qualified not in catalog.KEEPERS:
        callables.call_back(ctx, arguments, frame, call)
    if held and not keeps_callables(name):
        deps |= callables.returned(ctx, held, arguments, BOTTOM, frame, call)
    written = catalog.written(qualified)
    if written is not None and written < len(arguments[0]):
        news = containers.through_statement(ctx, Value(deps), frame, call)
        containers.change(ctx, arguments[0][written], news, call.arguments[written:], frame)
    for keyword, expr in call.keywords:
        if keyword in catalog.WRITTEN_KEYWORDS and keyword in arguments[1]:
            news = containers.through_statement(ctx, Value(deps), frame, call, keyword)
            containers.change(ctx, arguments[1][keyword], news, [expr], frame)
    if written is None:
        written_by = Invocation(name, BOTTOM, arguments, frame, call)
        filling.fill(ctx, written_by, dropped=dropped(frame, call))
    it = Invocation(qualified, BOTTOM, arguments, frame, call)
    drawings.pass_to_function(ctx, it, unused=dropped(frame, call))
    if catalog.scalar(qualified):
        same = qualified == "builtins.float" and len(arguments[0]) == 1
        return Value(deps, arguments[0][0].pts if same else frozenset())
    made = new_object(ctx, arguments, deps, frame, call, fields=_has_fields(qualified))
    callables.hold(ctx, made.pts, held)
    filling.note_streams(ctx, made, arguments)
    if qualified in catalog.RESERVING and qualified.startswith("numpy."):
        decides = ctx.use(arguments[0][0]) if arguments[0] and not shaped else NONE
        ctx.store.put(
            (next(iter(made.pts)), heap.SHAPE), Value(decides | ctx.use(arguments[1].get("shape", BOTTOM)))
        )
    if name[:1].isupper():
        callables.make_instances(ctx, arguments, made, frame, call)
        senders.note(ctx, qualified, made, arguments, frame, call)
    _name_class(ctx, qualified, made, arguments)
    return made


def _name_class(ctx: Interpreter, qualified: str, made: Value, arguments: Arguments) -> None:
    """Store the class of an object if it matters: for messages, settings on methods, arrays, ports, and files.

    For a server of markers, also store the first text among the arguments, which is the server's namespace.
    """
    markers = qualified in catalog.MARKER_SERVERS or qualified in catalog.MARKER_MENUS
    if not (
        markers
        or MESSAGE_MODULE in qualified
        or qualified in (catalog.IMAGE_TRANSPORT, "sched.scheduler")
        or qualified in catalog.BUFFERS
        or (ctx.thorough and qualified in catalog.BROADCASTERS)
        or qualified.startswith(containers.NAMED)
        or qualified in catalog.RESERVING
        or (ctx.config.named and qualified.rpartition(".")[2][:1].isupper())
    ):
        return
    texts = [one for one in (*arguments[0], *arguments[1].values()) if markers and one.names()]
    for obj in made.objects:
        obj.name = qualified
        for given in texts[:1]:
            ctx.store.put((obj, NAMESPACE), given)


def _has_fields(qualified: str) -> bool:
    """Return whether keyword arguments become fields of the new object.

    For a process, they do not: `stdout` of a process is a stream.
    """
    return qualified.rpartition(".")[2][:1].isupper() and qualified not in containers.PROCESSES


def new_object(
    ctx: Interpreter, arguments: Arguments, deps: frozenset[int], frame: Frame, call: ir.Call, *, fields: bool
) -> Value:
    """Return a new library object; keyword arguments of a class become fields."""
    obj = recency.allocate(ctx, "lib", frame, ("made", call.slot))
    where = pointer(obj)
    plain, named = arguments
    if fields:
        obj.info = BY_CLASS
        rest = NONE
        for value in plain:
            rest |= ctx.use(value)
        for name, value in named.items():
            if name in ("*", "**"):
                rest |= ctx.use(value)
            else:
                ctx.store.put((obj, name), value)
        deps = rest
    if deps:
        ctx.store.put((obj, ANY), Value(deps))
    return where


def dropped(frame: Frame, call: ir.Call) -> bool:
    """Return whether a call's result is unused, so that its purpose is a side effect."""
    return isinstance(frame.statement, ir.Evaluate) and frame.statement.value is call


BUILTIN: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(environment.VARIABLES, environment.variable),
    **dict.fromkeys(CONTAINERS, containers.new_container),
    **dict.fromkeys(QUEUES, containers.new_queue),
    **dict.fromkeys(files_by_path.OPENING, files_by_path.opened),
    **dict.fromkeys((*files_by_path.PATHS, *files_by_path.RESOLVING), files_by_path.path_of),
    **dict.fromkeys(files_by_path.WRITING, files_by_path.written),
    **dict.fromkeys(files_by_path.READING, files_by_path.read),
    "eval": reflection.evaluated,
    **dict.fromkeys(("csv.writer", "csv.DictWriter"), filling.stream_itself),
    **dict.fromkeys(element_trees.TREES, element_trees.tree),
    **dict.fromkeys(element_trees.SUBELEMENTS, element_trees.subelement),
    "ChainMap": records.several_mappings,
    **dict.fromkeys(containers.PIPES, containers.new_pipe),
    "dict": records.new_mapping,
    "weakref.WeakSet": containers.new_container,
    **dict.fromkeys(("weakref.WeakValueDictionary", "weakref.WeakKeyDictionary"), records.new_mapping),
    "logging.getLogger": logging_handlers.named_logger,
    "logging.Handler.__init__": logging_handlers.initialised,
    heap.NAMESPACE: objects.namespace,
    "OrderedDict": records.new_mapping,
    "defaultdict": records.new_mapping,
    "Counter": records.new_mapping,
    "dict.fromkeys": records.from_keys,
    "namedtuple": records.named_tuple_class,
    "dataclasses.field": records.field_default,
    "dataclasses.replace": records.replaced_record,
    "copy.replace": records.replaced_record,
    **dict.fromkeys(("dataclasses.asdict", "attr.asdict", "attrs.asdict"), records.as_mapping),
    **dict.fromkeys(("dataclasses.astuple", "attr.astuple", "attrs.astuple"), records.as_sequence),
    **dict.fromkeys(("dataclasses.fields", "attr.fields", "attrs.fields"), records.described_fields),
    **dict.fromkeys(("attr.evolve", "attrs.evolve"), records.replaced_record),
    **dict.fromkeys(("object.__new__", "type.__new__"), objects.blank_object),
    "object.__setattr__": reflection.set_attribute,
    **dict.fromkeys(("weakref.ref", "weakref.WeakMethod"), objects.weak_reference),
    **dict.fromkeys(("weakref.proxy", "vars", "typing.cast"), objects.same),
    "type": objects.type_of,
    "property": objects.property_of,
    enumerations.AUTO: enumerations.automatic,
    "isinstance": type_queries.is_instance,
    "hasattr": type_queries.has_attribute,
    "callable": type_queries.is_callable,
    "issubclass": type_queries.of_type,
    "rospy.myargv": command_line.own_arguments,
    "rclpy.utilities.remove_ros_args": command_line.own_arguments,
    **dict.fromkeys(("range", "xrange"), command_line.counted),
    "len": containers.counted_elements,
    **dict.fromkeys(("bool", "any", "all"), iterators.asked),
    "str": strings.as_text,
    "int": strings.as_number,
    **dict.fromkeys(catalog.SAME_TEXT, strings.same_text),
    **dict.fromkeys(catalog.PATH_JOINS, strings.joined_path),
    "enumerate": iterators.zipped_elements,
    "zip": iterators.zipped_elements,
    "map": iterators.mapped_elements,
    **dict.fromkeys(("filter", *iterators.SELECTING), iterators.mapped_elements),
    "itertools.compress": iterators.compressed,
    "itertools.starmap": iterators.star_mapped,
    "functools.reduce": iterators.reduced,
    "itertools.groupby": ordering.grouped,
    **dict.fromkeys(("heapq.nlargest", "heapq.nsmallest"), ordering.first_elements),
    function_wrappers.WRAPS: function_wrappers.wraps,
    function_wrappers.UPDATES: function_wrappers.update_wrapper,
    "heapq.heappop": heaps.popped,
    **dict.fromkeys(("heapq.heappush", "heapq.heappushpop", "heapq.heapreplace"), heaps.pushed),
    **dict.fromkeys(("bisect.insort", "bisect.insort_left", "bisect.insort_right"), heaps.pushed),
    "min": ordering.chosen_element,
    "max": ordering.chosen_element,
    "next": containers.next_element,
    "asyncio.gather": futures.gathered_results,
    **dict.fromkeys(catalog.ADDS_STATE, smach.add_state),
    **dict.fromkeys(catalog.STATE_BY_CALLBACKS, state_callbacks.state_by_callbacks),
    **dict.fromkeys(smach.MACHINES, smach.new_machine),
    **dict.fromkeys(behaviour_trees.COMPOSITES, behaviour_trees.composite),
    **dict.fromkeys(behaviour_trees.DECORATORS, behaviour_trees.decorator),
    **dict.fromkeys(behaviour_trees.CONSTANTS, behaviour_trees.constant),
    **dict.fromkeys(behaviour_trees.CHECKS, behaviour_trees.check),
    behaviour_trees.COMPARISON: behaviour_trees.comparison,
    **dict.fromkeys(blackboards.CLIENTS, blackboards.new_client),
    **dict.fromkeys(blackboards.GETTERS, blackboards.read),
    **dict.fromkeys(blackboards.SETTERS, blackboards.write),
    **dict.fromkeys(catalog.AWAITING, futures.awaited_result),
    **dict.fromkeys(catalog.IN_THREADS, futures.called_in_thread),
    "getattr": reflection.get_attribute,
    **dict.fromkeys(("operator.attrgetter", "operator.itemgetter"), reflection.getter),
    **dict.fromkeys(("operator.attrgetter.<made>", "operator.itemgetter.<made>"), reflection.get_named),
    "types.MethodType": reflection.bound_method,
    "dir": reflection.member_names,
    "inspect.getmembers": reflection.members,
    "functools.partialmethod": reflection.partial_method,
    "setattr": reflection.set_attribute,
    "super": objects.parent,
}
