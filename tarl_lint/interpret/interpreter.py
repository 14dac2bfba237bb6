"""The state of the abstract interpretation, shared by all its parts.

The parts are modules of functions that take the interpreter as `ctx`. The functions of a part call lower
parts directly, and higher parts through `ctx.ops` (declared in `operations.py`, assigned in `wiring.py`).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence

from tarl_lint.interpret.budget import MAX_APART, READS_PER_STATEMENT
from tarl_lint.interpret.operations import Operations
from tarl_lint.interpret.registrations import Registrations
from tarl_lint.interpret.run_order import Group, Part
from tarl_lint.interpret.state import NullnessFacts, Registered, Work
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import Branch, Control, control_dependence
from tarl_lint.ir.exception_types import exception_types
from tarl_lint.ir.lower_statements import lower_body
from tarl_lint.memory.frames import Frame, Spared, Turns, inside
from tarl_lint.memory.shared import Root, Shared
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Graph, Place
from tarl_lint.memory.values import NONE, Branches, Key, Nodes, Obj, Value
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord
from tarl_lint.parameter_names import ARGUMENTS, LAUNCHED, Launched, ParameterName
from tarl_lint.read.module_names import Index
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config

NONE_ONLY = frozenset([None])
# environment variable: also execute calls that could be replayed, and compare the results
CHECK = "TARL_CHECK"


Probe = Callable[["Interpreter", Frame, ir.Stmt, ir.Expr, Value], None]


def control_of(function: ir.Function) -> object:
    """Return a function's control dependence.

    It is replaced when a call in the function is found to raise a new exception.
    """
    return function.control


class Interpreter:
    """State of the interpretation of a whole set of modules."""

    def __init__(self, modules: Sequence[Module], config: Config, ops: Operations[Interpreter]) -> None:
        self.ops = ops
        self.config = config
        self.thorough = True  # whether to follow every value, and not only values from a source
        self.modules = {m.path: m for m in modules}
        self.index = Index(modules)
        self.registrations = Registrations([m.tree for m in modules], [w.name for w in config.wrappers])
        self.exception_types = exception_types(m.tree for m in modules)
        self.programs: dict[str, ir.Program] = {}
        self.module_objects: dict[str, Obj] = {}
        self.by_path: dict[str, ir.Program] = {}
        self.pending: dict[Root, None] = {}  # roots to run
        self.graph = Graph()
        self.shared = Shared()
        self.store = Store(self.shared, Root("none", "none"))
        self.objects: dict[Hashable, Obj] = {}
        self.frames: dict[Hashable, Frame] = {}
        self.frame_numbers: dict[Hashable, int] = {}
        self.stack: list[Frame] = []
        # (object whose `__init__` is running, height of the call stack)
        self.building: list[tuple[Obj, int]] = []
        self.senders: dict[Obj, object] = {}  # library objects that publish → their description
        self.delivered: frozenset[Obj] = frozenset()  # messages delivered in this run
        self.nullness = NullnessFacts()
        self.unchanged: set[ir.Call] = set()  # calls that return a value unchanged; only in thorough runs
        # value loaded from a file → path and position of the call that loads it
        self.settings: dict[Obj, tuple[str, ir.Pos]] = {}
        self.patient = True  # whether a later root may still store values that are unknown now
        self.waiting: dict[Root, None] = {}  # roots that read a value that is unknown so far
        # node that no source has reached so far → roots that ignored the node for this reason
        self.doubts: dict[int, dict[Root, None]] = {}
        # conditions inside the current expression (as in `a if b else c`) that decide what is evaluated
        self.guards: list[tuple[int, str]] = []
        self.spared: Spared = (
            frozenset()
        )  # what does not decide the method call that begins, for its receiver
        # implementations of functions with `singledispatch` → names of the types for which they are registered
        self.dispatches: dict[Obj, frozenset[str]] = {}
        self.class_made: Obj | None = None  # the class that the running metaclass creates
        self.members = False  # whether a class is an enumeration whose members are sequences
        self.counting: ir.Stmt | None = None  # the statement in which numbers are followed one by one
        self.repeating = False  # whether the element of a comprehension is evaluated again
        self.work = Work()
        self.widened: set[Hashable] = set()  # call contexts that several calls share
        self.cut: dict[str, None] = {}  # programs whose analysis is incomplete
        self.roots: dict[Hashable, tuple[Root, Callable[[Root], None]]] = {}
        self.given: set[Obj] = set()  # objects that are arguments of roots
        self.registered: dict[Hashable, Registered] = {}  # root → the calls that register it
        self.passed: dict[Hashable, list[Value]] = {}  # root → its arguments
        # sources by path, position and topics; for a launched node, the key has the call context instead of the
        # topics
        self.sources: dict[Hashable, SourceRecord] = {}
        self.apart: dict[tuple[str, ir.Pos], int] = {}  # registration → number of its sources
        # sinks by path, position and publisher; for a launched node, the key has the call context instead of the
        # publisher
        self.sinks: dict[Hashable, SinkRecord] = {}
        self.sent: dict[tuple[str, ir.Pos], int] = {}  # publish call → number of its sinks
        self.called: set[tuple[str, int]] = set()  # module and line of each called function
        # instance made by methods → the chain of its makers: allocation sites and objects, from the first maker to
        # the instance itself
        self.chains: dict[Obj, tuple[tuple[Hashable, Obj], ...]] = {}
        # key of a closure made by a call → the functions of the chain of closures that made this closure, with the
        # closure itself last
        self.closure_chains: dict[Hashable, tuple[ir.Function, ...]] = {}
        self.made: set[Hashable] = set()  # keys of instantiated classes
        self.guests: set[object] = set()  # classes that only code outside the analysed files instantiates
        self.plugins: set[object] = set()  # classes that a package declares as plugins
        self.looked_up: set[Obj] = set()  # classes whose instances a library looks up
        self.wanted: set[Obj] = (
            set()
        )  # classes that annotate parameters of functions that code outside the files calls
        self.parts: dict[Obj, Part] = {}  # states of machines and behaviours of trees
        self.groups: dict[Obj, Group[Obj]] = {}  # the machines and trees that contain these parts
        # allocation site → nodes that put its objects into containers
        self.inserted: dict[Hashable, set[int]] = {}
        # allocation site → nodes that put something into its containers, or set its events
        self.filled: dict[Hashable, set[int]] = {}
        self.opened: list[Value] = []  # the context managers of the `with` statements that are running
        self.handed_over: set[Obj] = set()  # functions with a decorator of a package that is not analysed
        # names of classes outside the analysed files whose methods receive data or callbacks
        self.ended: set[str] = set()
        # mailbox of generators → data that each root has sent
        self.posted: dict[Obj, dict[Root, Nodes]] = {}
        # mailbox → roots that have executed the body of one of these generators
        self.receivers: dict[Obj, dict[Root, None]] = {}
        self.checking = os.environ.get(CHECK, "") not in ("", "0")
        # ROS parameters whose values are names of topics or nodes; None if the run does not collect them
        self.parameter_names: list[ParameterName] | None = None
        # place of a call that reads or declares parameters → their names; None if some are unknown
        self.parameter_reads: dict[tuple[str, ir.Pos], set[str] | None] = {}
        self.fixed: Mapping[str, object] = {}  # known values of parameters, by their name in the code
        self.probe: Probe | None = None
        self.watch: Callable[[Frame, ir.Stmt], None] | None = None

    @property
    def launching(self) -> bool:
        """Return whether the run is for a launch file: names depend on nodes, clients have servers."""
        return self.parameter_names is not None

    @property
    def following_clients(self) -> bool:
        """Return whether requests to services and goals of actions count as sinks, and their answers as sources."""
        return self.launching or self.config.clients

    @property
    def command_line(self) -> tuple[str, ...]:
        """Return the command line of the launched node, `sys.argv`; empty if it is not known."""
        given = self.fixed.get(ARGUMENTS)
        return given if isinstance(given, tuple) else ()

    @property
    def launched(self) -> Launched | None:
        """Return the launched node with its parameters; None if the run is for all nodes of the program."""
        given = self.fixed.get(LAUNCHED)
        return given if isinstance(given, Launched) else None

    @property
    def exact(self) -> bool:
        """Return whether the run is for one launched node, so that constants are followed singly."""
        return self.launched is not None or bool(self.command_line)

    def end_key(self, path: str, pos: ir.Pos, frame: Frame) -> tuple[Hashable, ...]:
        """Return a flow end's key; for a launch, with call context and unrolled loop iteration."""
        return (path, pos, frame.id, *frame.turn) if self.launching else (path, pos)

    def source_key(
        self, path: str, pos: ir.Pos, frame: Frame, topics: Collection[str]
    ) -> tuple[Hashable, ...]:
        """Return the key of a subscription.

        For a launch, it is formed like the key of any end. Otherwise it contains the topics, for at most MAX_APART
        sources at one call.
        """
        place = (path, pos)
        key = self.end_key(path, pos, frame) if self.launching else (*place, *sorted(topics))
        if self.launching or key in self.sources:
            return key
        known = self.apart.setdefault(place, 0)
        if known >= MAX_APART:
            return place
        self.apart[place] = known + 1
        return key

    @property
    def total(self) -> int:
        """Return the work of all earlier runs, in statements."""
        return self.work.total

    @property
    def program(self) -> str:
        """Return the program of the current root, whose statements are charged."""
        return self.work.charged_to(self.store.root.program)

    def hurried(self, program: str) -> bool:
        """Return whether the program of a file has exceeded its budget."""
        spent = self.work.exhausted(program)
        if spent:
            self.cut[self.work.charged_to(program)] = None
        return spent

    def note_import(self, found: Module, importer: Module) -> None:
        """Charge an imported file's roots to importing programs, unless it is itself a program."""
        importers = self.work.importers.setdefault(found.path, {})
        if importer.path in importers or importer is found or importer.name.startswith(f"{found.name}."):
            return
        if not (found.started or found.contains("__main__")):
            importers[importer.path] = importer.is_package
            self.work.owners.clear()

    def count(self, looks: int = 0) -> None:
        """Add object reads and graph operations to the work, as a number of statements."""
        self.work.spent += (looks + self.graph.asked) // READS_PER_STATEMENT
        self.graph.asked %= READS_PER_STATEMENT

    def look(self, objects: Iterable[Obj]) -> None:
        """Note that the running call depends on these objects: their meaning, fields and data. Stamps record these."""
        noted = self.store.reads.objects
        for obj in objects:
            if obj not in noted:
                noted[obj] = obj.stamp

    # --- places -----------------------------------------------------------------------------------------

    def branches(self, frame: Frame, statement: ir.Stmt | None, turns: Turns | None = None) -> Branches:
        """Return all conditions of a statement, with those of callers. `turns` defaults to the current iterations."""
        if statement is None:
            return frame.base
        turns = inside(statement, frame.turns if turns is None else turns)
        key = (statement.id, turns)
        known = frame.closures.get(key)
        if known is None:
            known = frame.closures[key] = self._conditions(frame, statement, turns)
        return known

    def calling(self, frame: Frame) -> Branches:
        """Return the conditions of the calls in the current statement of a function.

        A `for` evaluates its iterable before it decides whether there is an element.
        """
        s = frame.statement
        found = self.branches(frame, s)
        if not isinstance(s, ir.Loop) or s.target is None:
            return found
        return found - {self.branch(frame, (s.id, way), inside(s, frame.turns)) for way in ("body", "done")}

    def _conditions(
        self, frame: Frame, statement: ir.Stmt, turns: Turns, but: ir.Loop | None = None
    ) -> Branches:
        """Return the conditions of a statement, except the conditions inside the loop `but`."""
        whole = self.control(frame)
        control = whole.iteration(turns[-1][0]) if turns else whole
        local = control.closure.get(statement.id, frozenset())
        found = {self.branch(frame, b, turns) for b in local if but is None or not but.has(b[0])}
        if not turns:
            return frame.base | found
        found.update(self.beginning(frame, turns))
        loop, _ = turns[-1]
        return self._conditions(frame, loop, turns[:-1], loop) | found

    def beginning(self, frame: Frame, turns: Turns) -> list[tuple[int, str]]:
        """Return the branches that decide whether the innermost of some iterations begins.

        Earlier iterations of an unrolled loop may decide, but not later ones. The conditions of the loop itself are not
        among the branches.
        """
        around, (loop, number) = turns[:-1], turns[-1]
        onward = self.control(frame).iteration(loop).onward
        found = [self.branch(frame, b, (*around, (loop, before))) for before in range(number) for b in onward]
        return [*found, self.branch(frame, (loop.id, "body"), around)]

    def branch(self, frame: Frame, branch: Branch, turns: Turns | None = None) -> tuple[int, str]:
        """Return a branch of a function in one of its frames and unrolled loop iterations."""
        number, way = branch
        turns = frame.turns if turns is None else turns
        if turns:
            turns = inside(self.control(frame).statements.get(number), turns)
        slot = f"condition {way}" if branch in frame.told_apart else "condition"
        key = (frame.id, number, slot, *((loop.id, turn) for loop, turn in turns))
        node = self.graph.numbers.get(key)
        if node is None:
            place = Place(frame, None, "condition", (0, 0, 0, 0))
            node = self.graph.node(key, place, NONE)  # type: ignore[arg-type]
            if turns:
                # what follows the loop depends on the decision of each iteration
                whole, _ = self.branch(frame, branch, turns[:-1])
                self.graph.depend(whole, [node])
        return node, way

    def condition(self, frame: Frame, statement: ir.Stmt, turns: Turns | None = None) -> int:
        """Return the node that represents the decision of a statement."""
        turns = inside(statement, frame.turns if turns is None else turns)
        return self._decision(frame, statement, "", turns)

    def way(self, frame: Frame, statement: ir.Stmt, way: str) -> int:
        """Return the node that decides only whether one branch of an `if` runs."""
        if (statement.id, way) not in frame.told_apart:
            frame.told_apart.add((statement.id, way))
            frame.closures = {}
        return self._decision(frame, statement, way, inside(statement, frame.turns))

    def _decision(self, frame: Frame, statement: ir.Stmt, way: str, turns: Turns) -> int:
        node, _ = self.branch(frame, (statement.id, way), turns)
        place = self.graph.places[node]
        if place.statement is None:
            self.graph.places[node] = Place(frame, statement, "condition", statement.pos)
            self.graph.branches[node] = self.branches(frame, statement, turns)
            if statement.id in self.control(frame).far:
                self.graph.control[node].update(b for b, _ in self.graph.branches[node])
            if turns:
                self._decision(frame, statement, way, turns[:-1])
        return node

    def control(self, frame: Frame) -> Control:
        """Return the control dependence of a frame's function."""
        function = frame.function
        if frame.cls is None:
            if function.control is None:
                body = lower_body(function, frame.program.package)
                function.control = control_dependence(
                    body, function.raising, self.exception_types, waits=self.config.arrivals
                )
            if frame.control is not function.control:
                frame.control = function.control
                frame.closures = {}
                frame.waypoints = set()
            self.graph.reads.ask(control_of, function)
        assert isinstance(frame.control, Control)  # noqa: S101 - set above, for classes when they are made
        return frame.control

    def node(
        self,
        frame: Frame,
        slot: Hashable,
        role: str,
        pos: ir.Pos | None = None,
        conditions: Collection[tuple[int, str]] = (),
    ) -> int:
        """Return the node of a value made by the frame's current statement, perhaps under further conditions."""
        statement = frame.statement
        key = (frame.id, statement.id if statement is not None else -1, slot, *frame.turn)
        known = self.graph.numbers.get(key)
        if known is not None:
            return known
        where = pos or (statement.pos if statement is not None else frame.function.pos)
        branches = self.branches(frame, statement)
        if conditions:
            branches = branches.union(conditions)
        return self.graph.node(key, Place(frame, statement, role, where), branches)

    def gathered(self, key: Key, value: Value) -> Value:
        """Replace the nodes of a field with very many values by one merged node."""
        if not self.stack or not self.graph.meets(key, value.deps, carriers=bool(value.pts)):
            return value
        return Value(self.graph.merged(key, value.deps, self.stack[-1]), value.pts, value.consts)

    def carry(self, value: Value, node: int) -> Value:
        """Return a value as it leaves the node of a statement."""
        content = self.ops.deep(self, value.pts) if value.pts else NONE
        if value.deps:
            self.graph.flow(self.settled(value), node)
        elif not content and not self.kept(node):
            return value
        if content:
            self.graph.hold(node, content)
        return Value(frozenset([node]), value.pts, value.consts)

    def kept(self, node: int) -> Nodes:
        """Return a node as dependency; empty if no source reaches it or its decisions (unless thorough)."""
        return frozenset([node]) if self.thorough else self.reached(node)

    def reached(self, node: int) -> Nodes:
        """Return a node as dependency of a value; empty if no source reaches the node or its decisions."""
        graph = self.graph
        live = graph.live
        if node in live:
            return frozenset([node])
        branches = graph.branches[node]
        for branch, _ in branches:
            if branch in live:
                return frozenset([node])
        unreached = graph.reads.unreached
        unreached.add(node)
        unreached.update([branch for branch, _ in branches])
        for branch, _ in branches:
            self.doubts.setdefault(branch, {})[self.store.root] = None
        if graph.data[node] or graph.control[node]:
            self.doubts.setdefault(node, {})[self.store.root] = None
        return NONE

    def use(self, value: Value) -> Nodes:
        """Return the nodes whose data is used where the whole value is used."""
        deps, pts = value.deps, value.pts
        if not pts:
            return deps if value.consts is None or not deps else self.settled(value)
        content = self.ops.deep(self, pts)
        if not content:
            return deps
        return deps | self.graph.through(content, deps) if deps else content

    def settled(self, value: Value) -> Nodes:
        """Return a value's dependencies, without branch conditions if all paths give the same constant."""
        if not value.deps or not value.fixed():
            return value.deps
        free = [d for d in value.deps if not self.graph.control[d]]
        for node in free:
            self.graph.reads.ask(self.graph.free, node)
        return frozenset(map(self.graph.unchosen, free))

    def inserted_by(self, obj: Obj) -> int:
        """Return the number of nodes that have put objects of an allocation site into containers."""
        return len(self.inserted.get(obj.site, ()))

    def filled_by(self, obj: Obj) -> int:
        """Return the number of nodes that put something into containers of an allocation site, or set its events."""
        return len(self.filled.get(obj.site, ()))

    def always_filled(self, objects: Iterable[Obj]) -> bool:
        """Return whether some statement fills one of several queues, or sets an event, without a condition on data."""
        found: set[int] = set()
        for obj in objects:
            self.store.reads.ask(self.filled_by, obj)
            found |= self.filled.get(obj.site, set())
        branches = (self.graph.branches[node] for node in sorted(found))
        return any(not any(self.reached(decision) for decision, _ in sorted(one)) for one in branches)

    def nothing_yet(self, value: Value) -> bool:
        """Return whether a value is still unset, or is None on all paths."""
        if value.pts or (value.deps and value.consts != NONE_ONLY):
            return False
        if value.consts == NONE_ONLY:
            return True
        if value.consts is None or value.consts:
            return False
        self.store.reads.ask(Interpreter.hopes, self)
        if not self.patient:
            return False
        self.waiting[self.store.root] = None
        return True

    def hopes(self) -> bool:
        """Return whether a later root may still store values that are unknown now."""
        return self.patient

    def sendings(self, mailbox: Obj) -> tuple[int, int]:
        """Return the number of roots that have sent data to generators, and of nodes. Neither number ever decreases."""
        sent = self.posted.get(mailbox, {})
        return len(sent), sum(map(len, sent.values()))

    def release(self) -> None:
        """Drop all references, to break reference cycles. The interpreter cannot be used afterwards."""
        for obj in (*self.objects.values(), *self.module_objects.values(), *self.frames.values()):
            obj.release()
        for record in self.sources.values():
            for message in record.messages.values():
                message.release()
        self.store = Store(self.shared, Root("none", "none"))
        self.graph.reads = self.store.reads
        for table in (self.objects, self.module_objects, self.frames, self.roots, self.sources, self.sinks):
            table.clear()
