"""Queries about single statements, answered by a further run of the analysis with observers."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from tarl_lint.flows.deciding import deciding
from tarl_lint.flows.reachability import Tracer
from tarl_lint.flows.statement_text import Texts
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, Obj, Value, join, join_all
from tarl_lint.model import Flow, Operand, SiteId, Span, Step
from tarl_lint.queries.held_constants import Holding, Origin, Origins
from tarl_lint.queries.operands import constructions, fills_an_object, sets_timing, timing_uses, uses

FILLED: Final = frozenset(
    ["lib", "sequence", "mapping"]
)  # kinds of objects that code fills with constants when it sets up a node
# kinds of objects to which code passes constants when it sets up a node: those of the program's own classes, and
# functions with stored arguments
MADE: Final = frozenset(["instance", "partial"])


@dataclass(slots=True)
class Seen:
    """Observations at one statement: values of its expressions, and its variables before it runs."""

    statement: ir.Stmt
    path: str
    values: dict[ir.Pos, Value] = field(default_factory=dict)
    holding: Holding = field(default_factory=Holding)

    def enter(self, expr: ir.Expr, value: Value) -> None:
        """Record a value of an expression."""
        before = self.values.get(expr.pos)
        self.values[expr.pos] = value if before is None else join(before, value)

    def objects(self, kinds: Collection[str]) -> frozenset[Obj]:
        """Return the objects of some kinds among the values."""
        return frozenset(o.whole for value in self.values.values() for o in value.pts if o.kind in kinds)

    def made(self) -> frozenset[Obj]:
        """Return the objects of the program's own classes, and the partial functions, that the statement makes."""
        results = (self.values.get(call.pos, BOTTOM) for call in constructions(self.statement))
        return frozenset(o.whole for value in results for o in value.pts if o.kind in MADE)


class Prober:
    """Observes every site of the flows in one further run."""

    def __init__(self, machine: Linker, flows: Sequence[Flow]) -> None:
        self.machine = machine
        self.texts = Texts(machine.modules)
        self.origins = Origins(machine)
        self.starts = {
            (step.span.path, step.span.line, step.span.column): step.site for f in flows for step in f.steps
        }
        self.seen: dict[SiteId, Seen] = {}
        self.deciding = {step.site: step for step in deciding(Tracer(machine), flows)}
        self.starts |= {(s.span.path, s.span.line, s.span.column): site for site, s in self.deciding.items()}
        self.timing: dict[SiteId, Step] = {}  # statements that wait or set a rate and are in no flow
        # statements that fill an object with constants and are in no flow, and the sites that use the object
        self.configuring: dict[SiteId, tuple[Step, tuple[SiteId, ...]]] = {}
        # statements outside all flows that pass constants to objects of the program's own classes or to partial
        # functions, and the sites that use these objects
        self.making: dict[SiteId, tuple[Step, tuple[SiteId, ...]]] = {}
        self._calls: dict[SiteId, Step] = {}
        self._files = {step.span.path for f in flows for step in f.steps}
        self._columns: dict[tuple[str, ir.Pos], SiteId | None] = {}
        machine.probe, machine.watch = self._look, self._arrive
        machine.replay()
        machine.probe = machine.watch = None
        self._find_configuring()

    def operands(self, site: SiteId) -> tuple[Operand, ...]:
        """Return the constants that a site uses, in source order."""
        seen = self.seen.get(site)
        if seen is None:
            return ()
        text = self.texts[seen.path]
        found: dict[ir.Pos, Operand] = {}
        found_by = timing_uses if site in self.timing else uses
        for expr in found_by(seen.statement, seen.values, self.origins):
            origins = self._origins(expr, seen.values)
            if not origins or expr.pos in found:
                continue
            values = {(type(o.value), o.value) for o in origins}
            single = next(iter(origins)) if len(origins) == 1 else None
            value = next(iter(origins)).value if len(values) == 1 else None
            span = text.stretch(expr.pos)
            definition = None
            if single is not None:
                definition = self.texts[single.path].stretch(single.pos) if single.path else span
            setting = single.setting if single is not None else ""
            several = self._places(origins) if single is None else ()
            found[expr.pos] = Operand(site, span, text.code(span), value, definition, setting, several)
        return tuple(sorted(found.values(), key=lambda o: o.span))

    def _places(self, origins: Collection[Origin]) -> tuple[Span, ...]:
        """Return the places where constants are defined, in order; empty if one of them has no place in a file."""
        if not all(origin.path for origin in origins):
            return ()
        return tuple(sorted({self.texts[one.path].stretch(one.pos) for one in origins}))

    def _origins(self, expr: ir.Expr, values: Mapping[ir.Pos, Value]) -> frozenset[Origin]:
        found = self.origins.of(expr, values.get(expr.pos))
        if not found and isinstance(expr, ir.Item):
            return self.origins.entries(values.get(expr.pos), values.get(expr.index.pos))
        return found

    def holders(self, topic: str, field: str, site: SiteId) -> tuple[str, ...]:
        """Return the expressions that contain a topic's unchanged field at a site, shortest first."""
        seen = self.seen.get(site)
        return seen.holding.expressions(topic.lstrip("/"), field, self.origins) if seen is not None else ()

    def _site(self, frame: Frame, statement: ir.Stmt) -> SiteId | None:
        key = (frame.program.path, statement.pos)
        if key not in self._columns:
            span = self.texts[key[0]].stretch(statement.pos)
            self._columns[key] = self.starts.get((span.path, span.line, span.column))
        return self._columns[key]

    def _timing(self, frame: Frame, statement: ir.Stmt) -> SiteId | None:
        """Add a site for a statement in a file on a flow, if the statement waits or sets a rate."""
        path = frame.program.path
        if path not in self._files or not sets_timing(statement):
            return None
        text = self.texts[path]
        written = text.statement(statement.pos)
        if written is None:
            return None
        site, span = text.site(written), text.span(written)
        self.timing[site] = Step(site, span, text.code(span), "call", "context")
        self._columns[path, statement.pos] = site
        return site

    def _call(self, frame: Frame, statement: ir.Stmt) -> SiteId | None:
        """Add a site for a statement in a file on a flow, if the statement may fill an object with constants."""
        path = frame.program.path
        if path not in self._files or not fills_an_object(statement):
            return None
        written = self.texts[path].statement(statement.pos)
        if written is None:
            return None
        text = self.texts[path]
        site, span = text.site(written), text.span(written)
        self._calls[site] = Step(site, span, text.code(span), "call", "context")
        self._columns[path, statement.pos] = site
        return site

    def _find_configuring(self) -> None:
        """Keep the statements that fill or make an object that a site uses."""
        users: dict[Obj, list[SiteId]] = {}
        for site in sorted(self.seen.keys() - self._calls.keys() - self.timing.keys()):
            for one in self.seen[site].objects(FILLED | MADE):
                users.setdefault(one, []).append(site)
        for site, step in self._calls.items():
            seen = self.seen[site]
            for objects, found in ((seen.objects(FILLED), self.configuring), (seen.made(), self.making)):
                using = {user for one in objects for user in users.get(one, ())}
                if using:
                    found[site] = (step, tuple(sorted(using)))
            if site not in self.configuring and site not in self.making:
                del self.seen[site]

    def _arrive(self, frame: Frame, statement: ir.Stmt) -> None:
        """Record the variables before a statement runs."""
        site = self._site(frame, statement) or self._timing(frame, statement) or self._call(frame, statement)
        if site is None:
            return
        seen = self.seen.get(site)
        if seen is None:
            seen = self.seen[site] = Seen(statement, frame.program.path)
        seen.holding.look(self.machine, frame)

    def _look(self, ctx: Interpreter, frame: Frame, statement: ir.Stmt, expr: ir.Expr, value: Value) -> None:  # noqa: ARG002
        """Record the value of an expression."""
        site = self._site(frame, statement)
        if site is None:
            return
        seen = self.seen.get(site)
        if seen is not None:
            seen.enter(expr, value)
            if isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute):
                seen.enter(expr.function, self._called(expr.function, seen))

    def _called(self, function: ir.Attribute, seen: Seen) -> Value:
        """Return the attribute that a call calls, such as `self.pid` in `self.pid(error)`. The engine looks it up."""
        base = seen.values.get(function.base.pos, BOTTOM)
        found = (self.machine.store.get((one, function.name)) for one in base.objects)
        return join_all([value for value in found if value is not None])
