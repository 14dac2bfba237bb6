"""Transfer functions of branches, loops, handlers and `with`."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret import dunder_methods, exceptions, expressions, operators, tags
from tarl_lint.interpret.budget import MAX_NESTED_ROWS, MAX_ROWS, MAX_STATEMENTS
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import leaving
from tarl_lint.memory import heap, joins
from tarl_lint.memory.frames import Attempt, Frame
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import BOTTOM, Value, join
from tarl_lint.models import context_managers as managers_of_generators
from tarl_lint.models import object_lists, rows, sizes, unpacking

MAX_TURNS = 4  # maximum number of known elements over which a loop is unrolled
MAX_EXACT_TURNS = 8  # value of MAX_TURNS in a run for one launched node
# a loop is unrolled over up to MAX_KNOWN elements if its body has at most this many plain statements
SHORT = 3
# maximum number of passes over a loop's body; only a safety limit, since the value domain is finite
MAX_PASSES = 12


def decide(ctx: Interpreter, test: ir.Expr, s: ir.Stmt, frame: Frame) -> bool | None:
    """Evaluate a condition; return its truth value if it is constant, else None."""
    node = ctx.condition(frame, s)
    value = expressions.evaluate(ctx, test, frame)
    frame.statement = s
    ctx.graph.flow(operators.truth(ctx, value, frame, "test"), node)
    known, constant = value.constant()
    constants = value.keys()
    if constants and not value.pts and not known:
        ways = {bool(c) for c in constants}
        return ways.pop() if len(ways) == 1 else None
    return bool(constant) if known else None


def if_statement(ctx: Interpreter, s: ir.If, frame: Frame) -> bool:
    """Execute an `if`; join the states after its branches. Return whether execution continues."""
    way = decide(ctx, s.test, s, frame)
    if way is not None:
        return ctx.ops.block(ctx, s.body if way else s.orelse, frame)
    goes_on: list[tuple[tags.Narrowed, Delta]] = []
    before: tags.Narrowed = {}
    ways: list[tuple[tags.Narrowed, Sequence[ir.Stmt]]] = []
    for body, holds in ((s.body, True), (s.orelse, False)):
        ctx.store.push()
        frame.statement = s
        narrowed = tags.narrow(ctx, s.test, frame, before, holds=holds)
        ways.append((narrowed, body))
        if narrowed:
            tags.decide(ctx, s, frame, narrowed, holds=holds)
        if ctx.ops.block(ctx, body, frame):
            goes_on.append((narrowed, ctx.store.pop()))
        else:
            ctx.store.pop()
    tags.settle(s, frame, before, ways)
    if goes_on:
        joins.merge(ctx, [state for _, state in goes_on])
        tags.restore(ctx, before, goes_on)
    return bool(goes_on)


def loop(ctx: Interpreter, s: ir.Loop, frame: Frame) -> bool:
    """Repeat the body until the state at the loop head is stable. Return whether execution continues."""
    source = BOTTOM
    if s.target is not None:
        registers = ctx.registrations.inside(s, s.nodes)
        way = "" if registers else ctx.registrations.publishes(s)
        names = ctx.registrations.names_attributes(s)
        each = registers or way == "direct" or names or ctx.registrations.asks(s)
        source = sizes.counted(ctx, s.source, frame, each=each)
        source = object_lists.without_empty(ctx, source)
        registers = registers or (
            ctx.registrations.calls_element(s, s.target, s.nodes) and rows.hold_classes(ctx, source)
        )
        if elements := _told_apart(ctx, s, source, frame, each=registers or names or way != ""):
            return _turns(ctx, s, s.target, source, elements, frame)
        if registers and sizes.is_empty(ctx, source):
            if source.consts is not None:
                return _loop_end(ctx, s, [{}], [], frame)
            source = Value(source.deps)  # an unknown list or an empty one, as in `names or []`
        elements = rows.of(ctx, source) if registers or names or way else []
        if elements and len(elements) * frame.rows <= MAX_NESTED_ROWS:
            passes = 1 if registers else MAX_PASSES
            return _turns(ctx, s, s.target, source, elements, frame, passes)
    depth = len(ctx.store.layers)
    head = _first_head(ctx, s, frame)
    for _ in range(MAX_PASSES):
        waited = ctx.store.waited
        ctx.store.push(head)
        table: dict[str, list[Delta]] = {"break": [], "continue": []}
        frame.jumps.append((depth, table))
        enters, leaves = _loop_head(ctx, s, source, frame)
        done = [ctx.store.since(depth)] if leaves else []
        backs: list[Delta] = []
        if enters:
            if ctx.ops.block(ctx, s.body, frame):
                backs.append(ctx.store.since(depth))
            backs += table["continue"]
        frame.jumps.pop()
        ctx.store.cut(depth)
        again = joins.joined(ctx, [head, *backs]) if backs else head
        if again == head and waited == ctx.store.waited:
            break  # after the first wait, one more pass reads the values that other entry points have stored
        if ctx.work.charged > MAX_STATEMENTS:
            ctx.cut[ctx.program] = None
            ctx.store.reads.whole = False
            # nested loops multiply the number of passes, so the loop stops at this limit although its state is not
            # stable yet
            break
        head = again
    frame.heads[(s.id, *frame.turn)] = head
    if ctx.config.arrivals and s.target is None:
        _may_not_end(ctx, s, frame)
    return _loop_end(ctx, s, done, table["break"], frame)


def _may_not_end(ctx: Interpreter, s: ir.Loop, frame: Frame) -> None:
    """Let what follows the call of this function depend on the end of a `while`: its condition, or what leaves it."""
    frame.blocked.update(dict.fromkeys(ctx.kept(ctx.condition(frame, s))))
    for one in leaving(s.body) if s.endless else ():
        for decision, _ in ctx.branches(frame, one):
            frame.blocked.update(dict.fromkeys(ctx.kept(decision)))


def _first_head(ctx: Interpreter, s: ir.Loop, frame: Frame) -> Delta:
    """Return a loop head's initial state: the fixpoint of its last execution in this call context.

    States only grow, from one pass of an outer loop to the next and from one run of an entry point to the next. The
    last fixpoint is therefore below the new one. If nothing has changed, an inner loop needs a single pass.
    """
    known = frame.heads.get((s.id, *frame.turn))
    return {} if known is None else joins.joined(ctx, [{}, known])


def _told_apart(ctx: Interpreter, s: ir.Loop, source: Value, frame: Frame, *, each: bool) -> list[Value]:
    """Return the elements to unroll a loop over; [] if they are unknown or too many.

    A loop is only unrolled if its elements carry data, or if `each` is True: then each iteration has topics of its
    own.
    """
    elements = sizes.unpacked(ctx, source) or []
    if any(o.name == heap.MEMBERS for o in source.pts):
        return elements
    plain = len(s.body) <= SHORT and all(isinstance(one, ir.Assign | ir.Evaluate) for one in s.body)
    asked = ctx.registrations.asks(s) and object_lists.asked(ctx, elements)
    limit = sizes.MAX_KNOWN if plain or asked else MAX_EXACT_TURNS if ctx.exact else MAX_TURNS
    if not 1 < len(elements) <= max(limit, MAX_ROWS):
        return []
    if each and len(elements) * frame.rows <= MAX_NESTED_ROWS:
        return elements
    if len(elements) > limit:
        return []
    if ctx.exact or asked:
        return elements  # such a loop iterates, for example, over groups of command-line arguments
    ctx.look(o for v in elements for o in v.pts)
    laden = any(v.deps or any(o.laden or o.kind == "message" for o in v.pts) for v in elements)
    return elements if laden else []


def _leaves(body: Sequence[ir.Stmt]) -> bool:
    """Return whether a statement may leave an iteration of a loop early."""
    inner = [
        part for s in body for name in ("body", "orelse", "final") for part in (getattr(s, name, ()) or ())
    ]
    handled = [part for s in body if isinstance(s, ir.Try) for handler in s.handlers for part in handler[2]]
    leaving = any(isinstance(s, ir.Jump | ir.Return | ir.Raise) for s in body)
    return leaving or (bool(inner or handled) and _leaves([*inner, *handled]))


def _turns(
    ctx: Interpreter,
    s: ir.Loop,
    target: ir.Expr,
    source: Value,
    elements: Sequence[Value],
    frame: Frame,
    passes: int = 0,
) -> bool:
    """Unroll a loop: execute the body once for each element.

    If `passes` is not 0, each element may be missing and the order of the elements is unknown. The loop is then
    repeated until its state is stable, but at most `passes` times.
    """
    depth, before, outside = len(ctx.store.layers), frame.turn, frame.steps
    turns, decides = frame.turns, not passes and frame.cls is None and ctx.registrations.asks(s)
    frame.steps = frozenset(s.body) if not passes and not _leaves(s.body) else frozenset()
    frame.rows *= len(elements)
    broken: list[Delta] = []
    ends: list[Delta] = []
    _length(ctx, source, ctx.condition(frame, s))
    done: Delta = {}
    before_pass: Delta | None = None
    for number, element in [*enumerate(elements)] * max(passes, 1):
        if not number:
            if done == before_pass:
                break
            before_pass = done
        ctx.store.push(done)
        table: dict[str, list[Delta]] = {"break": broken, "continue": []}
        frame.jumps.append((depth, table))
        frame.turn = (*before, -1 - s.id, number)
        frame.turns = (*turns, (s, number)) if decides else turns
        frame.statement = s
        ctx.ops.bind_target(ctx, target, element, frame, "element", s.source)
        ends = [ctx.store.since(depth)] if ctx.ops.block(ctx, s.body, frame) else []
        ends += table["continue"]
        frame.jumps.pop()
        ctx.store.cut(depth)
        if passes:
            ends.append(done)
        if not ends:
            break
        done = joins.joined(ctx, ends)
    frame.rows //= len(elements)
    frame.turn, frame.turns, frame.steps = before, turns, outside
    return _loop_end(ctx, s, [done] if ends else [], broken, frame)


def _loop_head(ctx: Interpreter, s: ir.Loop, source: Value, frame: Frame) -> tuple[bool, bool]:
    """Evaluate the condition or bind the next element; return whether the body and the end are reachable."""
    frame.statement = s
    if ctx.watch is not None:
        ctx.watch(frame, s)
    if frame.root_waits and (s.target is None or unpacking.blocks(ctx, source)):
        ctx.ops.wait(ctx, frame)
    if s.target is None:
        way = decide(ctx, s.source, s, frame)
        return way is not False, way is not True and not s.endless
    node = ctx.condition(frame, s)
    _length(ctx, source, node)
    element = unpacking.iterated(ctx, source, s.source, frame)
    ctx.ops.bind_target(ctx, s.target, element, frame, "element", s.source)
    return True, True


def _length(ctx: Interpreter, source: Value, node: int) -> None:
    """Make a loop's decision depend on the container's length, not on the data of its elements."""
    ours = frozenset(o for o in source.pts if sizes.sized(ctx, o))
    ctx.graph.flow(sizes.length(ctx, source), node)
    ctx.graph.choice(sizes.placed(ctx, ours), node, counted=True)


def _loop_end(ctx: Interpreter, s: ir.Loop, done: list[Delta], broken: list[Delta], frame: Frame) -> bool:
    if done and s.orelse:
        ctx.store.push(done[0])
        depth = len(ctx.store.layers) - 1
        done = [ctx.store.since(depth)] if ctx.ops.block(ctx, s.orelse, frame) else []
        ctx.store.cut(depth)
    if not done and not broken:
        return False
    joins.merge(ctx, [*done, *broken])
    return True


def with_statement(ctx: Interpreter, s: ir.With, frame: Frame) -> bool:
    """Execute a `with`, with `__enter__` and `__exit__` of analysed classes, or both parts of a generator."""
    managers: list[tuple[Value, Value]] = []
    for number, (context, target) in enumerate(s.items):
        value = expressions.evaluate(ctx, context, frame)
        frame.statement = s
        entered = _special_of_manager(ctx, value, managers_of_generators.ENTERING, (), frame, s)
        rest = BOTTOM
        if entered is None:
            entered, rest = managers_of_generators.entered(ctx, value)
        managers.append((value, rest))
        if target is not None:
            ctx.ops.bind_target(ctx, target, entered, frame, f"with{number}", context)
    ctx.opened += [manager for manager, _ in managers]
    body = Attempt(len(ctx.store.layers) - 1, [])
    frame.tries.append(body)
    goes_on = ctx.ops.block(ctx, s.body, frame)
    frame.tries.pop()
    del ctx.opened[len(ctx.opened) - len(managers) :]
    frame.statement = s
    # The managers also exit if a `return` or an exception leaves the body.
    given = exceptions.given_to_exit(ctx, body, frame, s.pos)
    for number, (manager, rest) in reversed([*enumerate(managers)]):
        _special_of_manager(ctx, manager, managers_of_generators.LEAVING, given, frame, s)
        rest = join(rest, managers_of_generators.kept_on_stack(ctx, manager))
        managers_of_generators.leave(ctx, rest, frame, s.pos, number)
    return goes_on


def _special_of_manager(
    ctx: Interpreter, manager: Value, names: Sequence[str], given: Sequence[Value], frame: Frame, s: ir.With
) -> Value | None:
    """Call a context manager's method, which may be asynchronous; None if its class has none."""
    for name in names:
        said = dunder_methods.special(ctx, manager, name, given, frame, s.pos)
        if said is not None:
            return said
    return None
