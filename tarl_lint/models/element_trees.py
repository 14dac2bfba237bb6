"""Models of `xml.etree.ElementTree`: an element contains its subelements, and a tree is represented by its root."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import updates
from tarl_lint.memory.values import Value

_MODULES: Final = ("xml.etree.ElementTree", "xml.etree.cElementTree", "lxml.etree")
TREES: Final = tuple(f"{module}.ElementTree" for module in _MODULES)
SUBELEMENTS: Final = tuple(f"{module}.SubElement" for module in _MODULES)


def tree(ctx: Interpreter, it: Invocation) -> Value:
    """Return the root of a tree, which represents it; a tree without a known root is an unknown object."""
    given = it.arguments[0]
    if given and given[0].pts:
        return given[0]
    return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)


def subelement(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new element as a part of its parent."""
    plain, named = it.arguments
    made = ctx.ops.generic(ctx, it.name, (plain[1:], named), it.frame, it.call)
    if plain and made.pts:
        updates.add_element(ctx, plain[0], made)
    return made
