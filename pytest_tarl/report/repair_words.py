"""Describe repairs in sentences: edits, reasons for rejection, and advice."""

from __future__ import annotations

from pytest_tarl.model import Attempt, Comparison, Edit, OperandEffect, Partial, Reason, Repair
from pytest_tarl.report.amounts import amount, atr
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.report.words import designed_world, world_name

REASONS: dict[Reason, str] = {
    "": "no reason was recorded",
    "no operand helps": "no change of a single constant restores the reward",
    "gain too small": "the best change found gains too little",
    "nominal gets worse": "the best change found makes the designed world worse",
    "budget": "the search reached its limit of episodes",
    "time": "the search reached its time limit",
    "interrupted": "the search was interrupted",
    "not confirmed": "its gain was not confirmed on further seeds",
    "worse than unrepaired": "on fresh seeds the best change found earns less than the unrepaired node",
    "another test gets worse": "the best change found makes another recorded test of the node worse",
    "not over the whole range": "the best change found works only in a part of the drift's range",
    "not at its definition": "the best change found works only at a use, but --tarl-edit=definition was given",
    "fails too often": "with the best change found, missions still fail too often",
    "not shown": "the best change found may be sufficient, but 200 episodes are too few to show it",
    "cannot be written": "the best change found cannot be written to the source",
    "never tested": "the best change found was not tested, because other candidates used all acceptance tests",
    "a smaller step breaks it": "even a smaller step of the best change found makes the designed world worse",
    "breaks other missions": "the best change found breaks missions that lose nothing under the drift",
}
ENDS: dict[Reason, str] = {
    "": "accepted",
    "gain too small": "dropped, it gains too little",
    "nominal gets worse": "dropped, the designed world gets worse",
    "not confirmed": "dropped, its gain was not confirmed on further seeds",
    "worse than unrepaired": "dropped, it earns less than the unrepaired node",
    "another test gets worse": "dropped, another test of the node gets worse",
    "not over the whole range": "dropped, it works only in a part of the drift's range",
    "not at its definition": "dropped, it works only at one use of the constant, not at its definition",
    "fails too often": "dropped, missions fail too often",
    "not shown": "dropped, 200 episodes are too few to show that it is sufficient",
    "cannot be written": "dropped, it cannot be written to the source",
    "never tested": "not tested, because other candidates used all acceptance tests",
    "a smaller step breaks it": "not run, a smaller step already makes the designed world worse",
    "breaks other missions": "dropped, missions that lost nothing get worse",
}

# a wider tolerance is suggested if at least this share of the loss was restored
NEARLY = 0.8
# suggested tolerance, as a multiple of the remaining loss; above 1, so that a test can show that the loss is smaller
SPARE = 1.5


def edit_words(edit: Edit) -> str:
    """Describe an edit; `→` precedes a new number, `×` a factor."""
    return edit.what or f"{edit.code} {'×' if edit.factor else '→'} {edit.value:g}"


def operand_words(operand: OperandEffect) -> str:
    """Describe the best change of an operand.

    The best change is a new value, a factor (if the old value is unknown), or the name that the operand follows.
    """
    return operand.what or f"{operand.code} {'×' if operand.value is None else '→'} {operand.best:g}"


def repair_words(repair: Repair) -> str:
    """Describe the repair and its condition, such as `5 → 12 at traveller.py:30 where terrain`."""
    places: dict[str, list[str]] = {}
    for edit in repair.edits:
        places.setdefault(f"{edit.path}:{edit.line}", []).append(edit_words(edit))
    edits = ", ".join(f"{', '.join(words)} at {place}" for place, words in places.items())
    return f"{edits} {f'where {repair.guard}' if repair.guard else 'everywhere'}"


def partial_words(partial: Partial, comparison: Comparison) -> str:
    """Describe what a partial repair gains, and its effect in the designed world."""
    sure = f"with about {percent(partial.confidence)} confidence"
    least = "least" if partial.designed_low >= 0.0 else "most"
    return (
        f"the drift costs {amount(partial.lost)} per episode, and the change regains {amount(partial.gain)} of it "
        f"(at least {amount(partial.low)}, {sure}); in the {designed_world(comparison)}, an episode with the change "
        f"earns {_more_or_less(partial.designed)} (at {least} {_more_or_less(partial.designed_low)})"
    )


def _more_or_less(difference: float) -> str:
    return f"{amount(abs(difference))} {'more' if difference >= 0.0 else 'less'}"


def refusal(repair: Repair) -> str:
    """Return why no repair was accepted."""
    return REASONS.get(repair.reason, repair.reason)


def best_words(repair: Repair) -> str:
    """Describe the best rejected candidate and its reward."""
    if repair.mean is None:
        return repair_words(repair)
    earned = f"{amount(repair.mean)} per episode, mean of {repair.episodes}"
    return f"{repair_words(repair)} ({earned})"


def attempt_words(attempt: Attempt) -> str:
    """Describe a candidate, its reward and its outcome."""
    outcome = ENDS.get(attempt.reason, attempt.reason)
    if not attempt.episodes:
        return f"{attempt.what}: {outcome}"
    kind = "fresh" if attempt.fresh else "known"
    return (
        f"{attempt.what}: {outcome}, mean reward {amount(attempt.mean)} in {attempt.episodes} {kind} episodes"
    )


def ways_out(comparison: Comparison) -> str:
    """Return advice if a candidate failed only in the designed world, or an empty text."""
    repair = comparison.repair
    if repair is None or repair.accepted or comparison.permanent:
        return ""
    against = [one.what for one in repair.history if one.reason == "nominal gets worse"]
    if repair.reason != "nominal gets worse" and not against:
        return ""
    what = repair_words(repair) if repair.reason == "nominal gets worse" else against[-1]
    name = comparison.drift or "worn"
    return (
        f"{what} restores the reward in {world_name(comparison)} but makes the designed world worse. Declare a "
        "sensor that distinguishes the two worlds, so that the repair can be conditional; or, if the drift is "
        "permanent, declare it so: "
        f'drifts={{"{name}": Drift(…, permanent=True)}}'
    )


def wider_tolerance(comparison: Comparison) -> str:
    """Return advice if a candidate restored nearly all of the loss, or an empty text."""
    repair, tolerance = comparison.repair, comparison.verdict.tolerance
    designed, deployed = atr(comparison, "offline"), atr(comparison, "online")
    if repair is None or repair.accepted or designed is None or deployed is None:
        return ""
    lacking = [one for one in repair.history if one.fresh and one.reason == "gain too small"]
    best = max(lacking, key=lambda one: one.mean, default=None)
    if (
        best is None
        or best.mean - deployed < NEARLY * (designed - deployed)
        or designed - best.mean <= tolerance
    ):
        return ""
    left = designed - best.mean
    wider = f"tolerance={SPARE * left:.2g}"
    share = percent((best.mean - deployed) / (designed - deployed))
    return (
        f"{best.what} restores {share} of the loss; {amount(left)} per episode remain, more than the tolerance of "
        f"{amount(tolerance)}. If that is acceptable, declare {wider} in the marker and search again"
    )
