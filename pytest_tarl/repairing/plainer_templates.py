"""Try a factor, such as `3.0 * turn`, instead of a change that keeps state.

For example, an integral also overcomes friction or a weak actuator, because the symptom is the same: an offset remains.
In these cases, a factor may be enough.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import templates
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching.search import Candidate

FACTORS = (2.0, 3.0, 5.0)  # factors that are tried, smallest change first
# name of the template that multiplies any number by a factor, and also the name of its parameter
GAIN = "gain"
REPLACED = ("value", "number")  # kinds of templates that a factor on the same expression can replace


def factors(order: Order, candidate: Candidate) -> Iterator[Candidate]:
    """Yield candidates that multiply an expression by a factor, in place of a candidate that stores state there."""
    found = {one.form and replace(one.form, parameter="") for one in candidate.mutations}
    form = found.pop() if len(found) == 1 else None
    gain = next((one for one in templates(order.root) if one.name == GAIN), None)
    if form is None or gain is None or not form.template.state or form.template.on not in REPLACED:
        return
    operand = candidate.mutations[0].operand
    if {one.operand.span for one in candidate.mutations} != {operand.span}:
        return
    defaults = tuple((one.name, one.default) for one in gain.parameters)
    start = dict(defaults)[GAIN]
    _, _, code = operand.code.partition(" of ")
    scaled = replace(operand, code=f"{GAIN} of {code.rpartition(',')[0] or code}, {GAIN}", value=start)
    bare = Form(gain, GAIN, defaults, partner=form.partner, field=form.field)
    for factor in FACTORS:
        yield Candidate((Mutation(scaled, factor / start, form=bare),), candidate.guard)
