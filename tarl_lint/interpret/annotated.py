"""Objects that code outside the files passes to a function: instances of the class that annotates the parameter."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from typing import Final

from tarl_lint.interpret.budget import MAX_ALIKE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, library_instances, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import UNKNOWN, Obj, Value, join_all, pointer
from tarl_lint.trees import last_name

SEQUENCES: Final = frozenset(
    ["list", "List", "Sequence", "Iterable", "tuple", "Tuple", "set", "Set", "Collection"]
)
WRAPPERS: Final = frozenset(["Optional", "Union", "Annotated"])


def handed(ctx: Interpreter, frame: Frame, name: str) -> Value:
    """Return the value of a parameter of a function that code outside the files calls."""
    annotation = written(frame.function).get(name)
    if annotation is None:
        return UNKNOWN
    module = ctx.module_objects[frame.program.name]
    classes = _classes(ctx, module, annotation)
    ctx.wanted.update(classes)
    given = [_some(library_instances.of_class(ctx, cls)) for cls in classes]
    several = isinstance(annotation, ast.Subscript) and last_name(annotation.value) in SEQUENCES
    value = join_all(one for one in given if one.pts)
    if not value.pts:
        return UNKNOWN
    if not several:
        return value
    listed = recency.allocate(ctx, "sequence", frame, ("handed", name))
    updates.add_element(ctx, pointer(listed), value)
    return pointer(listed)


def _some(value: Value) -> Value:
    """Return a value with the first MAX_ALIKE objects of each class; these stand for all objects of the class."""
    kept: list[Obj] = []
    alike: Counter[object] = Counter()
    for obj in value.objects:
        alike[obj.info] += 1
        if alike[obj.info] <= MAX_ALIKE:
            kept.append(obj)
    return value if len(kept) == len(value.pts) else Value(value.deps, frozenset(kept), value.consts)


def written(function: ir.Function) -> dict[str, ast.expr]:
    """Return the annotations of a function's parameters."""
    if isinstance(function.node, ast.Lambda):
        return {}
    given = function.node.args
    found = {a.arg: a.annotation for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)}
    return {name: _parsed(one) for name, one in found.items() if one is not None}


def classes_of_parameters(ctx: Interpreter, function: ir.Function, module: Obj) -> list[Obj]:
    """Return the analysed classes that annotate the parameters of a function."""
    return [cls for one in written(function).values() for cls in _classes(ctx, module, one)]


def _parsed(annotation: ast.expr) -> ast.expr:
    if isinstance(annotation, ast.Constant) and isinstance(annotation.value, str):
        try:
            return ast.parse(annotation.value, mode="eval").body
        except SyntaxError:
            return annotation
    return annotation


def _classes(ctx: Interpreter, module: Obj, annotation: ast.expr) -> list[Obj]:
    """Return the analysed classes that an annotation names."""
    found: dict[Obj, None] = {}
    for path in named_types(annotation):
        value = pointer(module)
        for part in path.split("."):
            value = heap.read(ctx, value, part)
        found.update(dict.fromkeys(o for o in value.objects if o.kind == "class"))
    return list(found)


def named_types(annotation: ast.expr) -> Iterator[str]:
    """Yield the names of the types in an annotation, including types in a union or a sequence."""
    annotation = _parsed(annotation)
    if isinstance(annotation, (ast.Name, ast.Attribute)):
        yield ast.unparse(annotation)
    elif isinstance(annotation, ast.BinOp):
        yield from named_types(annotation.left)
        yield from named_types(annotation.right)
    elif isinstance(annotation, ast.Subscript) and last_name(annotation.value) in SEQUENCES | WRAPPERS:
        inner = annotation.slice
        for one in inner.elts if isinstance(inner, ast.Tuple) else [inner]:
            yield from named_types(one)
