"""Describe the result of a stress test in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from pytest_tarl.spaces import Choice, Point, Space, Span, nominal, value_of
from pytest_tarl.stressing.findings import (
    CONFIDENCE,
    Boundary,
    Curve,
    Failure,
    Stress,
    confirmed,
    contains,
    failure,
)
from pytest_tarl.stressing.rays import Ray

MOST_SHOWN = 5  # maximum number of combinations, and of statements, to show
SURE = f"{100 * CONFIDENCE:.3g} %"
ROUNDING = 1e-9  # two positions on a ray count as equal if they differ by at most this

ENDED = {
    "budget": "The budget of {budget} did not suffice for the whole search: raise --tarl-stress-budget.",
    "interrupted": "Interrupted after {episodes} episodes: these are the results so far.",
}


def lines(stress: Stress) -> Iterator[str]:
    """Yield the lines for the terminal."""
    yield f"{stress.test}[{stress.drift}]: stress, {stress.episodes} episodes"
    yield f"  guarantee  {guarantee_words(stress)}"
    if stress.ended == "nominal":
        yield f"  nominal    {nominal_words()}"
        return
    for name, sentences in directions(stress):
        for number, sentence in enumerate(sentences):
            yield f"  {name if not number else '':10} {sentence}"
    for number, sentence in enumerate(together(stress)):
        yield f"  {'together' if not number else '':10} {sentence}"
    for number, sentence in enumerate(undecided_promises(stress)):
        yield f"  {'must_hold' if not number else '':10} {sentence}"
    for number, sentence in enumerate(statement_words(stress)):
        yield f"  {'statements' if not number else '':10} {sentence}"
    yield from (f"  {'variance':10} {sentence}" for sentence in sobol_words(stress))
    yield from (f"  {sentence}" for sentence in ended_words(stress))


def ended_words(stress: Stress) -> Iterator[str]:
    """Yield sentences on why the run ended early and whether it can be reproduced."""
    if stress.ended in ENDED:
        yield ENDED[stress.ended].format(budget=budget_words(stress), episodes=stress.episodes)
    if stress.seconds is not None:
        yield (
            "A time limit is not reproducible; for the same number of episodes, use --tarl-stress-budget "
            f"{stress.episodes}."
        )


def budget_words(stress: Stress) -> str:
    """Return the budget with its unit."""
    return f"{stress.budget} episodes" if stress.seconds is None else f"{stress.seconds:g} s"


def guarantee_words(stress: Stress) -> str:
    """Return the guarantee as a sentence."""
    given = stress.guarantee
    return (
        f"At least {100 * given.rate:.4g} % of the episodes pass, and the mean reward is at most "
        f"{given.tolerance:.3g} below the recorded one."
    )


def nominal_words() -> str:
    """Return the advice for a guarantee that already fails at the nominal values."""
    return (
        "The guarantee already fails at the nominal values, so the nominal world is not the recorded one: correct the "
        "nominal values, or record again with `pytest --tarl-record`."
    )


def directions(stress: Stress) -> Iterator[tuple[str, list[str]]]:
    """Yield each direction with its sentences."""
    for name, curves in groupby(stress.curves, key=lambda curve: curve.ray.names[0]):
        own = list(curves)
        extent = stress.space.extents[name]
        if isinstance(extent, Choice):
            yield name, [_option(curve) for curve in own]
        else:
            yield name, [*_range(name, extent, own), *_held(name, own)]


def together(stress: Stress) -> Iterator[str]:
    """Yield sentences on failing combinations, nearest first, without those that contain a nearer one."""
    found, shown = stress.combinations, _innermost(stress)[:MOST_SHOWN]
    for one in shown:
        where = of_point(stress.space, one.point)
        yield f"Fails with {where} (distance {one.distance:.2g}){_alone(stress, one)}."
    if len(found) > len(shown):
        yield _left_out(len(found) - len(shown), "failing combination")
    if stress.nearer is not None:
        where = of_point(stress.space, stress.nearer.point)
        distance = f"{stress.nearer.distance:.2g}"
        yield f"The guarantee probably already fails with {where} (distance {distance}); this is not confirmed."
    elif not found and stress.tried:
        yield f"No combination was found that fails although each of its changes alone passes ({stress.tried} tried)."


def _left_out(count: int, noun: str, which: str = "") -> str:
    """Return a sentence on results that only the JSON result lists."""
    told = f"{noun}{which} is" if count == 1 else f"{noun}s{which} are"
    return f"{count} more {told} in the JSON result."


def _innermost(stress: Stress) -> list[Failure]:
    """Return the failing combinations that contain no nearer one, nearest first."""
    kept: list[Failure] = []
    for one in sorted(stress.combinations, key=lambda one: (one.distance, one.names)):
        if not any(contains(stress.space, one.point, near.point) for near in kept):
            kept.append(one)
    return kept


def _alone(stress: Stress, one: Failure) -> str:
    """Return the remark that the guarantee seems to hold under each change alone, or an empty text."""
    for curve in stress.curves:
        (name,) = curve.ray.names
        extent = stress.space.extents[name]
        usual = nominal(extent)
        way, moved = curve.ray.value(1.0) - usual, one.point[name] - usual
        reached = moved / way if isinstance(extent, Span) else float(moved == way)
        if reached > 0.0 and (not curve.swept or any(t <= reached + ROUNDING for t in curve.failing)):
            return ""
    return ", although no failure was found with each change alone"


def sobol_words(stress: Stress) -> Iterator[str]:
    """Yield sentences on the Sobol indices, the most important direction first."""
    if stress.sobol is None:
        return
    shares = sorted(stress.sobol.shares, key=lambda one: -one.total)
    if stress.sobol.hopeless:
        yield (
            f"All {stress.sobol.episodes} episodes drawn from the whole space fail clearly, so the shares of the "
            "directions are unknown: narrow the ranges."
        )
        return
    if not any(one.total for one in shares):
        yield f"The margin varies nowhere in the space ({stress.sobol.episodes} episodes)."
        return
    parts = (
        f"{one.name} {max(one.first, 0.0):.0%} alone, {one.total:.0%} ± {one.total_error:.0%} with combinations"
        for one in shares
    )
    yield (
        f"Shares of the margin's variance over the space: {'; '.join(parts)} "
        f"(Sobol indices, {stress.sobol.episodes} episodes)."
    ).replace("%", " %")


def statement_words(stress: Stress) -> Iterator[str]:
    """Yield sentences on the statements that ran only in failures."""
    found = stress.statements
    if found is None:
        return
    if not found.only:
        yield f"No statement ran only in failures ({found.failing} failing episodes, {found.others} others)."
    for one in found.only[:MOST_SHOWN]:
        yield (
            f"{one.path}:{one.line} ran in {one.failing} of {found.failing} failing episodes and in none of "
            f"{found.others} others: {one.text}"
        )
    if len(found.only) > MOST_SHOWN:
        yield _left_out(len(found.only) - MOST_SHOWN, "statement", " that ran only in failures")


def repair_lines(stress: Stress) -> Iterator[str]:
    """Yield sentences on the repair searches."""
    for one in stress.repairs or ():
        yield f"{one.region}: {one.told}"
        for moved in one.moved:
            if moved.before != moved.after or moved.change != "no significant change":
                yield f"{moved.name}: {moved.before} → {moved.after}: {moved.change}"
        if one.draws is not None:
            draws = one.draws
            yield (
                f"over the declared space: {draws.passed_after} of {draws.episodes} fresh draws pass with the "
                f"repair, {draws.passed_before} without it; success at least {100 * draws.success_at_least:.3g} "
                f"% with 95 % confidence; mean reward {draws.reward_after:.4g} instead of "
                f"{draws.reward_before:.4g}."
            )
        if one.withheld:
            yield f"The repair is withheld, since {one.withheld}."


def broken_promises(stress: Stress) -> list[str]:
    """Return a sentence for each confirmed failure inside `must_hold`, single directions first."""
    alone = [one for one in confirmed(stress.curves) if _promised(stress, one)]
    together = [one for one in _innermost(stress) if _promised(stress, one)]
    return [
        *(f"The guarantee fails {_but_must_hold(stress, one)}." for one in alone),
        *(
            f"The guarantee fails with {of_point(stress.space, one.point)}, but must_hold includes this combination."
            for one in together
        ),
    ]


def undecided_promises(stress: Stress) -> list[str]:
    """Return a sentence for each direction that seems to fail inside `must_hold`, without a confirmed failure."""
    found = []
    for curve in stress.curves:
        places = [t for t in curve.failing if _promised(stress, failure(stress.space, curve.ray.point(t)))]
        if places and curve.confirmed is None:
            told = of_point(stress.space, curve.ray.point(places[0]))
            found.append(
                f"Undecided: {told} is within must_hold and suspicious, but no failure was confirmed."
            )
    return found


def _but_must_hold(stress: Stress, one: Failure) -> str:
    """Return where a failure along one direction is, and which values `must_hold` declares for it."""
    (name,) = one.names
    told, limits = of_point(stress.space, one.point), stress.must_hold[name]
    if isinstance(extent := stress.space.extents[name], Choice):
        return f"with {told}, but must_hold includes {shown(extent, one.point[name])}"
    return f"at {told}, but must_hold is {limits[0]:g} to {limits[1]:g}"


def _promised(stress: Stress, one: Failure) -> bool:
    """Return whether every direction of a failure is inside its `must_hold` (by default, the nominal value)."""
    return all(_inside(stress, name, one.point[name]) for name in one.names)


def _inside(stress: Stress, name: str, number: float) -> bool:
    limits = stress.must_hold.get(name)
    if limits is None:
        return False
    extent = stress.space.extents[name]
    if isinstance(extent, Choice):
        return value_of(extent, number) in limits
    return bool(limits[0] - ROUNDING <= number <= limits[1] + ROUNDING)


def shown(extent: Span | Choice, number: float) -> str:
    """Return a direction's value as text."""
    value = value_of(extent, number)
    return f"{value:.3g}" if isinstance(value, float) else repr(value)


def _range(name: str, extent: Span, curves: list[Curve]) -> list[str]:
    if all(not curve.swept for curve in curves):
        return ["Not examined."]
    whole = [curve for curve in curves if curve.swept]
    if not any(curve.failing for curve in whole) and len(whole) == len(curves):
        places = sum(len(curve.evidence) for curve in curves)
        return [
            f"Not affected by {name}: no failure found from {extent.low:.3g} to {extent.high:.3g} ({places} values)."
        ]
    return [_side(name, curve) for curve in curves]


def _held(name: str, curves: list[Curve]) -> list[str]:
    """Return a sentence on the sides of a range that have no boundary: how far the guarantee holds there."""
    limits = [
        f"{name} {_sign(curve.ray)} {_number(curve.ray, curve.held)}"
        for curve in curves
        if curve.held is not None and curve.confirmed is None
    ]
    return [f"The guarantee holds while {' and '.join(limits)} ({SURE} each)."] if limits else []


def _sign(ray: Ray) -> str:
    return "≤" if ray.value(1.0) > nominal(ray.space.extents[ray.names[0]]) else "≥"


def _side(name: str, curve: Curve) -> str:
    """Return a sentence on one side of a range."""
    ray, boundary = curve.ray, curve.boundary
    sign = _sign(ray)
    if boundary is not None:
        return f"No failure found while {name} {sign} {_number(ray, boundary.at)} ({_uncertainty(ray, boundary)})."
    if curve.failing:
        return (
            f"No failure confirmed while {name} {sign} {_number(ray, 1.0)}; suspicious from {name} = "
            f"{_number(ray, curve.failing[0])} on."
        )
    if not curve.swept:
        return f"Not examined from {_number(ray, 0.0)} to {_number(ray, 1.0)}."
    return f"No failure found while {name} {sign} {_number(ray, 1.0)}, the end of the range."


def _uncertainty(ray: Ray, boundary: Boundary) -> str:
    monotone = (
        "monotone: checked"
        if boundary.monotone
        else "not monotone: the guarantee holds again at larger drifts"
    )
    if boundary.near is None:
        return f"boundary not beyond {_number(ray, boundary.far)}, {monotone}"
    low, high = sorted((ray.value(boundary.near), ray.value(boundary.far)))
    return f"boundary {low:.3g} to {high:.3g} at {SURE}, {monotone}"


def _option(curve: Curve) -> str:
    name = curve.ray.names[0]
    option = value_of(curve.ray.space.extents[name], curve.ray.farthest[name])
    if curve.confirmed is not None:
        return f"Fails with {name}={option!r}."
    if curve.failing:
        return f"No failure confirmed with {name}={option!r}, but the option is suspicious."
    if curve.held is not None:
        return f"No failure found with {name}={option!r}; the guarantee holds ({SURE})."
    return f"{'No failure found' if curve.swept else 'Not examined'} with {name}={option!r}."


def _number(ray: Ray, t: float) -> str:
    return f"{ray.value(t):.3g}"


def of_point(space: Space, point: Point) -> str:
    """Return the values of a point that differ from nominal, in words."""
    changed = [name for name, number in point.items() if number != space.nominal[name]]
    return " and ".join(f"{name}={shown(space.extents[name], point[name])}" for name in changed)


def point_values(stress: Stress, point: Point) -> dict[str, Any]:
    """Return the value of each direction: a number from a range, or an option."""
    return {name: value_of(extent, point[name]) for name, extent in stress.space.extents.items()}
