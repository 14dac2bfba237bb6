"""Literal factors that convert units by definition; no drift changes them.

In `kpa = msg.fluid_pressure / 1000.0`, a smaller divisor has the same effect as a lower threshold for `kpa`, but nobody
looks for the change there. A sensor whose values are too large is corrected by a separate factor.
"""

from __future__ import annotations

import ast
from math import isclose, pi

from pytest_tarl.patching.document import Document, argument_names

TIME = (1e-9, 1e-6, 1e6, 1e9)  # factors between units of time, wherever they are
# ratios of units that are hardly ever a gain: parts of a thousand, degrees per radian, km/h per m/s
CERTAIN = (1e3, 180 / pi, 3.6)
# ratios that are also usual gains: percent or centimetres, minutes, hours
LIKELY = (100.0, 60.0, 3600.0)
ROUNDED = 1e-3  # relative error of a written ratio: 57.3 for 180/π
_PI = ("pi", "math.pi", "np.pi", "numpy.pi")


def converts_unit(source: Document, node: ast.expr) -> bool:
    """Return whether an expression is a literal factor or divisor that converts a unit.

    A ratio of units of time or of degrees counts anywhere. Any other ratio counts only if it scales a number of the
    message that the function receives. A ratio that may also be a gain counts only if the statement does nothing else
    with this number.
    """
    around = source.parents.get(node)
    if not isinstance(node, ast.Constant) or not isinstance(around, ast.BinOp):
        return False
    value, divides = node.value, isinstance(around.op, ast.Div)
    if isinstance(value, bool) or not isinstance(value, int | float) or not value:
        return False
    if not divides and not isinstance(around.op, ast.Mult):
        return False
    if value in TIME or (value == 180 and _beside_pi(source, around)):
        return True
    other = around.left if around.right is node else around.right
    if (divides and around.left is node) or not _of_message(source, other):
        return False
    alone = isinstance(source.parents.get(around), ast.Assign | ast.AnnAssign | ast.Return)
    return _is_ratio(value, CERTAIN) or (alone and _is_ratio(value, LIKELY))


def _is_ratio(value: float, ratios: tuple[float, ...]) -> bool:
    return any(isclose(value, one, rel_tol=ROUNDED) for ratio in ratios for one in (ratio, 1.0 / ratio))


def _beside_pi(source: Document, product: ast.BinOp) -> bool:
    """Return whether a product, or the product around it, has a factor or divisor π."""
    chain: list[ast.AST] = [product]
    around = source.parents.get(product)
    while isinstance(around, ast.BinOp) and isinstance(around.op, ast.Mult | ast.Div):
        chain.append(around)
        around = source.parents.get(around)
    return any(
        isinstance(one, ast.Name | ast.Attribute) and ast.unparse(one) in _PI for one in ast.walk(chain[-1])
    )


def _of_message(source: Document, node: ast.expr) -> bool:
    """Return whether an expression is a field of an argument, without computation."""
    function = source.function(node)
    if function is None:
        return False
    names = argument_names(function)
    parts = list(ast.walk(node))
    computes = any(isinstance(each, ast.BinOp | ast.IfExp | ast.Compare) for each in parts)
    return not computes and any(
        isinstance(each, ast.Attribute) and ast.unparse(each).partition(".")[0].partition("[")[0] in names
        for each in parts
    )
