"""Replace a change of a function's return value by changes at the calls that need it.

A getter such as `def p(self, name): return self.get_parameter(name).value` returns many constants. A factor on the
return value changes all these constants, but a maintainer would change only those that are wrong.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pytest_tarl.patching.document import called
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand


def calls_of(unit: Unit, among: Sequence[Unit]) -> list[Unit]:
    """Return the units that are calls of the function whose return value `unit` changes.

    Units on a chart are left out. They use another scale, on which the return value's factor has no meaning.
    """
    operand = unit.operands[0]
    function = operand.site.qualname.rpartition(".")[2]
    if not operand.site.text.startswith("return ") or not function:
        return []
    return [other for other in among if other.chart is None and _called(other.operands[0]) == function]


def _called(operand: Operand) -> str:
    """Return the name of the function or method that an operand calls, or ""."""
    try:
        node = ast.parse(operand.code, mode="eval").body
    except SyntaxError:
        return ""
    if not isinstance(node, ast.Call):
        return ""
    return called(node)
