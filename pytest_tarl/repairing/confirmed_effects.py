"""Add the gains of structural changes and of the accepted repair to the effects that the searches measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isclose
from statistics import fmean

from pytest_tarl.model import OperandEffect
from pytest_tarl.searching.search import Candidate, operand_effect

# values with this relative difference count as the same, because the value at a definition is rounded
SAME = 0.01

Effects = Mapping[str, Sequence[OperandEffect]]


def gaining(effects: Effects, structural: Effects) -> Effects:
    """Add the structural changes that gained reward to the effects, so that their statements rank by this gain.

    Both arguments map site ids to effects.
    """
    found = {site: tuple(each) for site, each in effects.items()}
    for site, each in structural.items():
        known = found.get(site, ())
        found[site] = (*known, *(one for one in each if one.effect > 0.0 and one not in known))
    return {site: each for site, each in found.items() if each}


def with_confirmed(
    effects: Effects, candidate: Candidate, repaired: Sequence[float], drifted: Sequence[float]
) -> Effects:
    """Add the gain of an accepted change of one constant, if the search did not measure it.

    `effects` maps site ids to effects. `repaired` and `drifted` are total rewards of episodes with and without the
    change. The search may have found the change under another condition, or together with other constants.
    """
    if len(candidate.mutations) != 1 or not repaired or not drifted:
        return effects
    (mutation,) = candidate.mutations
    confirmed = operand_effect(mutation, fmean(repaired) - fmean(drifted))
    known = effects.get(str(mutation.operand.site), ())
    same = [one for one in known if (one.code, one.what) == (confirmed.code, confirmed.what)]
    if any(isclose(one.best, confirmed.best, rel_tol=SAME) and one.effect > 0.0 for one in same):
        return effects
    others = [one for one in known if one.code != confirmed.code]
    return {**effects, str(mutation.operand.site): (confirmed, *others)}
