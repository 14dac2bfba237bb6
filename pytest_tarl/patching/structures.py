"""Apply a repair template to an expression, with state if the template needs it."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, Edit, Function, Loop
from pytest_tarl.patching.expression_texts import choice, fitted, number
from pytest_tarl.patching.templates import FIELD, PAIR, Template, filled, plainly
from pytest_tarl.patching.vocabulary import class_attributes, free, names
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Span

_OPS: dict[type[ast.cmpop], str] = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_CLOSED = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}


@dataclass(frozen=True, slots=True)
class Form:
    """A template at an expression, with its parameters and sensor."""

    template: Template
    parameter: str = ""
    defaults: tuple[tuple[str, float], ...] = ()
    # the other expression of a swapped pair, or the same expression for another axis
    partner: Span | None = None
    sensor: Sensor | None = None
    field: str = ""  # for a published message: the field to change, such as `linear.x`
    sibling: Sensor | None = None  # the partner's sensor, if it has its own
    variable: str = ""  # a variable of the program that is used instead of a sensor

    def target(self, code: str) -> str:
        """Return the code to change: the expression, or a field of it."""
        return f"{code}.{self.field}" if self.field else code


@dataclass(frozen=True)
class Keeper:
    """Where a node keeps state between calls."""

    prefix: str
    place: int
    indent: str
    behind: str = ""  # text after the new lines
    declare: int | None = None  # where a function declares its global variables (offset)
    declare_indent: str = ""


def described(form: Form, x: str, y: str, values: Mapping[str, float], sensor: str = "") -> str:
    """Describe the effect of a form in a sentence."""
    texts = _numbers(form.template, values)
    left, op, right = _compared(x)
    named = {"left": left, "op": op, "right": right, "closed": _CLOSED.get(op, "")}
    return plainly(form.template.summary, {"x": x, "y": y, "sensor": sensor, **named, **texts})


def form_edits(
    source: Document, node: ast.expr, form: Form, values: Mapping[str, float], condition: str, sensor: str
) -> list[Edit]:
    """Return the edits that write a form. Raise RepairError if it does not fit."""
    made = form.template
    statement = source.statement(node)
    fill = _numbers(made, values) | {"sensor": sensor}
    keeper = _keeper(source, statement) if made.state else None
    taken = set(names(source)) | class_attributes(source)
    states = {}
    for name, _ in made.state:
        assert keeper is not None  # noqa: S101
        states[name] = free(f"{name}_{_short(statement, node)}", taken)
        taken.add(states[name])
        fill[name] = keeper.prefix + states[name]
    found = _written(_Place(source, statement, node, form, condition), fill)
    if keeper is not None:  # state is declared first, because `global` has to precede the use
        found = _state_edits(keeper, [(states[name], initial) for name, initial in made.state]) + found
    return found


def _numbers(template: Template, values: Mapping[str, float]) -> dict[str, str]:
    """Return each parameter value as code; counts are integers."""
    counts = {one.name for one in template.parameters if one.grid == 1.0}
    return {name: number(round(value) if name in counts else float(value)) for name, value in values.items()}


@dataclass(frozen=True)
class _Place:
    """An expression with a form, its statement and its condition."""

    source: Document
    statement: ast.stmt
    node: ast.expr
    form: Form
    condition: str

    def named(self, name: str, fill: Mapping[str, str]) -> tuple[list[str], str]:
        """Return the lines that a form adds, and the new expression."""
        fill = {**fill, "x": name}
        new = filled(self.form.template.expression, fill)
        lines = [filled(line, fill) for line in self.form.template.lines]
        return lines, choice(self.condition, new, name) if self.condition else new


def _written(place: _Place, fill: Mapping[str, str]) -> list[Edit]:
    source, node, made = place.source, place.node, place.form.template
    code = source.source(node)
    if made.on == FIELD:
        return _ahead_of_publishing(place, fill)
    if made.on == PAIR:
        return _swapped(source, node, place.form, place.condition)
    if made.on == "comparison":
        left, op, right = _compared(code)
        if not op:
            raise RepairError(f"{source.path}:{node.lineno} compares more than two values.")
        back = "+" if op.startswith("<") else "-"
        fill = {**fill, "left": left, "op": op, "right": right, "closed": _CLOSED[op], "back": back}
    again = made.uses("x") > 1 or bool(made.lines)
    if again and made.on != "comparison" and not isinstance(node, ast.Name | ast.Attribute):
        if _target(place.statement) is not None and place.statement.value is node:  # type: ignore[attr-defined]
            return _behind(place, fill)
        return _ahead(place, fill)
    if made.lines and not _can_stand_before(source, place.statement):
        raise RepairError(f"{source.path}:{node.lineno}: no line can be inserted before this one.")
    lines, text = place.named(code, fill)
    start, indent = source.start(place.statement), source.indentation(place.statement)
    before = [Edit(start, start, f"{line}\n{indent}") for line in lines]
    return [*before, Edit(source.start(node), source.end(node), fitted(source, node, text))]


def _behind(place: _Place, fill: Mapping[str, str]) -> list[Edit]:
    """Change a value after it is assigned. Raise RepairError."""
    source, statement = place.source, place.statement
    target = _target(statement)
    if target is None or statement.value is not place.node or not source.alone(statement):  # type: ignore[attr-defined]
        raise RepairError(f"{source.path}:{place.node.lineno}: the value is not assigned to a name.")
    name = source.source(target)
    lines, text = place.named(name, fill)
    indent, end = source.indentation(statement), source.line_end(statement)
    return [Edit(end, end, "".join(f"\n{indent}{line}" for line in (*lines, f"{name} = {text}")))]


def _ahead(place: _Place, fill: Mapping[str, str]) -> list[Edit]:
    """Assign an unnamed value to a name before its statement."""
    source, statement, node = place.source, place.statement, place.node
    if not _can_stand_before(source, statement) or not _always_evaluated(source, statement, node):
        raise RepairError(
            f"{source.path}:{node.lineno}: the value cannot be assigned to a name before this line."
        )
    code = source.source(node)
    name = free(_short(statement, node), set(names(source)))
    lines, text = place.named(name, fill)
    start, indent = source.start(statement), source.indentation(statement)
    first = f"{name} = ({code})" if "\n" in code else f"{name} = {code}"
    before = "".join(f"{line}\n{indent}" for line in (first, *lines))
    return [
        Edit(start, start, before),
        Edit(source.start(node), source.end(node), fitted(source, node, text)),
    ]


def _ahead_of_publishing(place: _Place, fill: Mapping[str, str]) -> list[Edit]:
    """Change a message field before the message is published."""
    source, statement, node = place.source, place.statement, place.node
    if not _can_stand_before(source, statement):
        raise RepairError(f"{source.path}:{node.lineno}: no line can be inserted before this one.")
    target = place.form.target(source.source(node))
    lines, text = place.named(target, fill)
    start, indent = source.start(statement), source.indentation(statement)
    factor = text.removeprefix(f"{target} * ")
    last = f"{target} *= {factor}" if factor != text and not place.condition else f"{target} = {text}"
    return [Edit(start, start, "".join(f"{line}\n{indent}" for line in (*lines, last)))]


def _always_evaluated(source: Document, statement: ast.stmt, node: ast.expr) -> bool:
    """Return whether a statement evaluates an expression exactly once each time it runs."""
    inner: ast.AST = node
    for around in source.ancestors(node):
        if around is statement:
            return not isinstance(statement, ast.While | ast.For)
        if isinstance(around, ast.Lambda | ast.GeneratorExp | ast.ListComp | ast.SetComp | ast.DictComp):
            return False
        if isinstance(around, ast.IfExp) and inner is not around.test:
            return False
        if isinstance(around, ast.BoolOp) and inner is not around.values[0]:
            return False
        inner = around
    return False


def _swapped(source: Document, node: ast.expr, form: Form, condition: str) -> list[Edit]:
    assert form.partner is not None  # noqa: S101
    other = source.find(form.partner)
    pairs = [(node, source.source(other)), (other, source.source(node))]
    return [
        Edit(
            source.start(one),
            source.end(one),
            fitted(source, one, choice(condition, new, source.source(one)) if condition else new),
        )
        for one, new in pairs
    ]


def _state_edits(keeper: Keeper, states: Sequence[tuple[str, str]]) -> list[Edit]:
    lines = [
        f"{keeper.prefix if keeper.prefix and keeper.indent and not keeper.behind else ''}{name} = {initial}"
        for name, initial in states
    ]
    text = f"\n{keeper.indent}".join(lines) + keeper.behind + f"\n{keeper.indent}"
    found = [Edit(keeper.place, keeper.place, text)]
    if keeper.declare is not None:
        declared = ", ".join(name for name, _ in states)
        found.append(Edit(keeper.declare, keeper.declare, f"global {declared}\n{keeper.declare_indent}"))
    return found


def _keeper(source: Document, statement: ast.stmt) -> Keeper:
    """Return where to keep state: on the instance, in a loop or in a global."""
    method = source.method(statement)
    if method is not None and source.function(statement) is method[1]:
        owner, _, instance = method
        init = next(
            (each for each in owner.body if isinstance(each, Function) and each.name == "__init__"), None
        )
        if init is not None and init.args.args:
            first = _first(init.body)
            return Keeper(
                f"{init.args.args[0].arg}." if init is method[1] else f"{instance}.",
                source.start(first),
                source.indentation(first),
            )
        first = _first(owner.body)
        place = source.line_start(first) + len(source.indentation(first))
        return Keeper(f"{instance}.", place, source.indentation(first), behind="\n")
    function = source.function(statement)
    around = [each for each in source.ancestors(statement) if isinstance(each, Loop)]
    inside = [each for each in around if source.function(each) is function]
    if inside:
        loop = inside[-1]
        return Keeper("", source.start(loop), source.indentation(loop))
    if function is None or source.parents[function] is not source.tree:
        raise RepairError(
            f"{source.path}:{statement.lineno}: there is no place to store state between calls."
        )
    first = _first(function.body)
    return Keeper("", source.line_start(function), "", "\n\n", source.start(first), source.indentation(first))


def _first(body: Sequence[ast.stmt]) -> ast.stmt:
    """Return a constructor's first statement that does something. Raise RepairError."""
    for statement in body:
        value = statement.value if isinstance(statement, ast.Expr) else None
        docstring = isinstance(value, ast.Constant) and isinstance(value.value, str)
        base = isinstance(value, ast.Call) and "__init__" in ast.unparse(value.func)
        if not docstring and not base:
            return statement
    raise RepairError("A function or class without statements after its docstring cannot store state.")


def _can_stand_before(source: Document, statement: ast.stmt) -> bool:
    simple = isinstance(
        statement, ast.Assign | ast.AnnAssign | ast.AugAssign | ast.Expr | ast.Return | ast.If
    )
    elif_ = isinstance(statement, ast.If) and source.text.startswith("elif", source.start(statement))
    return simple and not elif_ and source.leads(statement)


def _target(statement: ast.stmt) -> ast.expr | None:
    """Return the only name or attribute that a statement assigns, or None."""
    target = None
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
        target = statement.targets[0]
    elif isinstance(statement, ast.AnnAssign):
        target = statement.target
    return target if isinstance(target, ast.Name | ast.Attribute) else None


def _short(statement: ast.stmt, node: ast.expr) -> str:
    """Return a short name for a value, from its target or from the left side of a comparison."""
    named = node.left if isinstance(node, ast.Compare) else node
    if getattr(statement, "value", None) is node or not isinstance(node, ast.Name | ast.Attribute):
        named = _target(statement) or named
    text = ast.unparse(named).rpartition(".")[2]
    return text if text.isidentifier() else "value"


def _compared(code: str) -> tuple[str, str, str]:
    """Return both sides of a comparison and its operator, which is empty for other code."""
    try:
        node = ast.parse(f"({code}\n)", mode="eval").body
    except SyntaxError:
        return code, "", ""
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _OPS:
        return ast.unparse(node.left), _OPS[type(node.ops[0])], ast.unparse(node.comparators[0])
    return code, "", ""
