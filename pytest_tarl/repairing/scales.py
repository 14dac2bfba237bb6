"""Choose the constants that are moved on a scale other than factors.

Such constants are zeros, shares close to 1, and named offsets that are small compared with the values to
which they are added.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.charts import SHARE, Chart, offset
from pytest_tarl.patching.constant_definitions import ParameterInFile
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import is_integral
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.typical_sizes import KEEPING_UNITS, TypicalSizes
from tarl_lint.model import Operand

NEARLY_ALL = 0.8  # for a share above this, its distance to 1 is a better scale than the share itself
SPREAD = 0.25  # usual size of an offset on a sensor's reading, as a share of the sensor's range


def charts(order: Order, operands: Sequence[Operand]) -> Mapping[Operand, Chart]:
    """Return the scales on which constants are moved in addition to factors on their values."""
    sizes = TypicalSizes(order)
    found: dict[Operand, Chart] = {}
    for operand in operands:
        chart = _chart(order, operand, sizes)
        if chart is not None:
            found[operand] = chart
    return found


def _chart(order: Order, operand: Operand, sizes: TypicalSizes) -> Chart | None:
    value = operand.value
    if value is None or isinstance(value, bool):
        return None
    try:
        source = document(operand.span.path, order.analysis.sources[operand.span.path])
        node = source.find(operand.span)
        if is_integral(order.analysis, operand):
            return None
    except (RepairError, KeyError):
        return None
    if isinstance(operand, ParameterInFile) and not value and operand.size:
        return offset(operand.size)
    if NEARLY_ALL <= value < 1.0:
        return SHARE
    if operand.literal and value:
        return None  # literals within a line are numerous and rarely offsets of a wrong size
    read = {} if value else _spreads(order, operand)
    size = max(_beside(source, node, operand, sizes, read), default=0.0)
    return offset(size) if size > abs(value) else None


def _spreads(order: Order, operand: Operand) -> Mapping[str, float]:
    """Map sensor readings of a statement to the usual size of an offset on them.

    If a reading is 1500 ± 100, a likely offset is about 100.
    """
    return {
        code: SPREAD * (sensor.high - sensor.low)
        for sensor in order.fixture.sensors
        if sensor.topic and sensor.path and sensor.low is not None and sensor.high is not None
        for code in order.analysis.holders(sensor.topic, sensor.path, operand.site)
    }


def _beside(
    source: Document, node: ast.expr, operand: Operand, sizes: TypicalSizes, read: Mapping[str, float]
) -> Iterator[float]:
    """Yield the usual sizes of values to which a constant is added, and of the sum.

    If the constant is 0, also yield the sizes of values that are combined or compared with it. For a sensor reading,
    yield the size in `read` instead. Yield nothing if the constant is a factor or stands alone. The results of most
    functions are not used, because they have another unit than the arguments.
    """
    inner: ast.AST = node
    for around in source.ancestors(node):
        if isinstance(around, ast.BinOp) and isinstance(around.op, ast.Add | ast.Sub):
            other = around.right if around.left is inner else around.left
            yield from filter(None, (read.get(ast.unparse(other)) or sizes.known(operand.site, other),))
        elif isinstance(around, ast.Compare) and operand.value != 0:
            return
        elif isinstance(around, ast.Compare):
            sides = [side for side in (around.left, *around.comparators) if side is not inner]
            yield from filter(None, (sizes.known(operand.site, side) for side in sides))
            return
        elif isinstance(around, ast.Call) and ast.unparse(around.func) not in KEEPING_UNITS:
            return
        elif not (isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.USub)):
            added = isinstance(around, ast.AugAssign) and isinstance(around.op, ast.Add | ast.Sub)
            if inner is not node or added:
                yield from filter(None, (sizes.by_site.get(str(operand.site)),))
            return
        inner = around
