"""Let a constant follow a sensor if it needs different values in different missions.

For example, a robot that drives faster has to look further ahead, but how far depends on its speed. A single look-ahead
for all fast missions fits only missions of about their mean speed. Two points are known: the old constant is right at
the sensor's designed value, and the value found is about right at the sensor's mean value in the drifted missions. A
power law leads through both points. On the other side of the designed value, the constant keeps its old value, because
designed missions go there, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import log

from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.between import factor
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import continuous, usual, varies
from pytest_tarl.repairing.variables_in_scope import variables
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand

ABOVE, BELOW, FOLLOWS = "above", "below", "follows"
APART = 1.25  # minimum ratio of a sensor's usual values in the two worlds
# smallest and largest exponent: with a smaller one, the sensor hardly matters; a larger one is needed only if the
# sensor changes too little
LEAST, MOST = 0.2, 4.0
SENSORS, VARIABLES = 2, 1  # maximum number of sensors and of variables that are tried


def following(order: Order, candidate: Candidate) -> Iterator[Candidate]:
    """Yield unconditional candidates that scale the changed constant by a power of a sensor or a variable.

    The sensors of the candidate's condition come first, then the other sensors. Variables that the node has where it
    uses the constant come last. They are needed because a quantity such as a speed may not be declared as a sensor. The
    usual values of the sensor or variable must differ clearly between the worlds. The candidate must change one
    constant by a positive factor, at one or all of its uses.
    """
    factors = {factor(one) for one in candidate.mutations}
    by = factors.pop() if len(factors) == 1 else None
    plain = all(
        one.form is None and one.chart is None and one.operand.value != 0 for one in candidate.mutations
    )
    if by is None or by <= 0.0 or by == 1.0 or not plain or order.permanent:
        return
    known = {one.name: one for one in templates(order.root)}
    if not {ABOVE, BELOW} <= known.keys():
        return
    found = [
        form for sensor in _sensors(order, candidate) if (form := _form(order, sensor, by, known)) is not None
    ]
    found = (
        found[:SENSORS]
        + [
            form
            for name, designed, drifted in variables(order, [one.operand for one in candidate.mutations])
            if (form := _law(Form(known[ABOVE], variable=name), designed, drifted, by)) is not None
        ][:VARIABLES]
    )
    for form in found:
        yield _candidate([one.operand for one in candidate.mutations], form)


def proportional(order: Order, used: Sequence[Operand]) -> Iterator[Candidate]:
    """Yield unconditional candidates in which a constant is proportional to a quantity that varies too much.

    Such quantities are the sensors that visit clearly more bins than in the designed world. If there are such sensors,
    the most suspect variable at the uses of the constant is tried, too. At the designed value of the quantity, the
    constant keeps its value.
    """
    plain = all(not isinstance(one.value, bool) and one.value != 0 for one in used)
    template = next((one for one in templates(order.root) if one.name == FOLLOWS), None)
    varying = [one for one in _usable(order) if varies(order, one)]
    if template is None or not plain or not varying or order.permanent:
        return
    held = [(name, designed) for name, designed, _ in variables(order, used) if designed > 0.0][:VARIABLES]
    forms = [_with_power(Form(template, variable=name), 1.0, designed) for name, designed in held]
    forms += [
        _with_power(Form(template, sensor=one), 1.0, usual(order, one, order.fixture.sample))
        for one in varying[:SENSORS]
    ]
    for form in forms:
        yield _candidate(used, form)


def _candidate(used: Sequence[Operand], form: Form) -> Candidate:
    return Candidate(tuple(Mutation(one, 1.0, form=form) for one in used), ALWAYS)


def _usable(order: Order) -> list[Sensor]:
    """Return the sensors whose values can be raised to a power."""
    numeric = [one for one in order.comparison.sensors if continuous(one)]
    return [one for one in numeric if one.low is not None and one.low >= 0.0]


def _sensors(order: Order, candidate: Candidate) -> Sequence[Sensor]:
    """Return the usable sensors, those of the condition first."""
    asked = [conjunct.sensor for conjunct in candidate.guard.conjuncts]
    return sorted(_usable(order), key=lambda one: one not in asked)


def _form(order: Order, sensor: Sensor, by: float, known: Mapping[str, Template]) -> Form | None:
    designed, drifted = usual(order, sensor, order.fixture.sample), usual(order, sensor)
    return _law(Form(known[ABOVE if drifted > designed else BELOW], sensor=sensor), designed, drifted, by)


def _law(form: Form, designed: float, drifted: float, by: float) -> Form | None:
    """Return a form that multiplies a constant by `by` through a power of a quantity, or None.

    `designed` and `drifted` are the usual values of the quantity in the two worlds.
    """
    ratio = drifted / designed
    rises = form.template.name == ABOVE
    if (ratio if rises else 1.0 / ratio) < APART:
        return None
    power = log(by) / log(ratio)
    if not LEAST <= abs(power) <= MOST:
        return None
    return _with_power(form, power, designed)


def _with_power(form: Form, power: float, designed: float) -> Form:
    """Return a form whose exponent is searched, starting at `power`; `designed` is the quantity's designed value."""
    defaults = (("power", float(f"{power:.2g}")), ("usual", float(f"{designed:.3g}")))
    return replace(form, parameter="power", defaults=defaults)
