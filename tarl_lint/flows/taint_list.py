"""The taint list of a flow: its statements in order, with roles and kinds of dependence."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

from tarl_lint.flows.context_steps import Surroundings
from tarl_lint.flows.node_statements import Statements
from tarl_lint.flows.statement_text import Texts, Written
from tarl_lint.flows.taint_list_parts import Part
from tarl_lint.flows.topological_order import in_order
from tarl_lint.model import Dependence, Role, Span, Step
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord

ROLES: Mapping[str, Role] = {
    "Return": "return",
    "If": "condition",
    "While": "condition",
    "Try": "condition",
    "Match": "condition",
    "match_case": "condition",
    "Assert": "condition",
    "Expr": "call",
}


@dataclass(slots=True)
class TaintList:
    """The steps of a flow; also statement → index of its step."""

    steps: tuple[Step, ...]
    index: Mapping[int, int]


class TaintLists:
    """Makes the taint lists of flows."""

    def __init__(self, texts: Texts, statements: Statements) -> None:
        self.surroundings = Surroundings(texts)
        self.statements = statements
        self._steps: dict[tuple[int, Dependence, Role | None], Step] = {}

    def of(self, origin: SourceRecord, on_data: Set[int], part: Part, record: SinkRecord) -> TaintList:
        """Return the taint list of a flow: data and control steps of the part's nodes, and the context steps.

        This method changes `part`, which belongs to this flow alone.
        """
        written, precedence = part.written, part.precedence
        dependence: dict[int, Dependence] = dict.fromkeys(written, "control")
        key_of = self.statements.key_of
        dependence.update((key, "data") for n in on_data if (key := key_of[n]) is not None)
        precedence.add_ahead_of_loops(part.turns, part.function)
        for key, call in part.passed.items():
            written.setdefault(key, call)
            dependence.setdefault(key, "control")
        precedence.update(part.entrances)
        context, outer = self.surroundings.context(origin, [(f, w) for (f, _), w in part.placed.items()])
        for item in context:
            written.setdefault(id(item), item)
            dependence.setdefault(id(item), "context")
        precedence.update(outer)
        registration = self.surroundings.registration(origin)
        arrivals = self.statements.arrivals(origin)
        precedence.update((id(registration), a) for a in arrivals)
        spans = {key: w.text.span(w) for key, w in written.items()}
        first = {*arrivals, *(key for key, kind in dependence.items() if kind == "context")}
        order = in_order(spans, precedence, first)
        sinks = {id(w) for n in record.nodes if (w := self.statements.of(n)) is not None}
        roles: dict[int, Role] = {**({id(registration): "register"} if registration is not None else {})}
        roles |= dict.fromkeys(arrivals, "receive")
        roles |= dict.fromkeys(sinks, "publish")
        steps = tuple(self.step(written[k], spans[k], dependence[k], roles.get(k)) for k in order)
        return TaintList(steps, {key: place for place, key in enumerate(order)})

    def step(self, written: Written, span: Span, dependence: Dependence, known: Role | None) -> Step:
        """Return a statement as a step; flows share equal steps."""
        key = id(written), dependence, known
        if key not in self._steps:
            self._steps[key] = new_step(written, span, dependence, known)
        return self._steps[key]


def new_step(written: Written, span: Span, dependence: Dependence, known: Role | None) -> Step:
    """Return a new step; an unknown role is derived from the syntax."""
    text = written.text
    role = ROLES.get(type(written.node).__name__, "assign")
    if known is not None:
        role = known
    elif written.qualname.endswith("<lambda>") and role == "assign":
        role = "return"
    elif type(written.node).__name__ in ("For", "AsyncFor") and dependence != "data":
        role = "condition"
    return Step(text.site(written), span, text.code(span), role, dependence)
