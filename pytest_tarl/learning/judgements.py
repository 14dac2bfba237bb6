"""Results of temporal formulas: one row per episode, one column per formula."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.formulas.judging import Judged, margin
from pytest_tarl.learning.tables import Judgements, Sample
from pytest_tarl.model import FormulaRow, FormulaWorld


def judgements(judged: Sequence[Judged]) -> Judgements | None:
    """Return the row of one episode, or None if no formula was judged."""
    if not judged:
        return None
    ordered = sorted(judged)
    return Judgements(
        formulas=tuple(one.formula for one in ordered),
        robustness=np.array([[one.robustness for one in ordered]], np.float64),
        lost=np.array([[one.lost for one in ordered]], np.float64),
    )


def together(samples: Sequence[Sample], picked: Sequence[tuple[int, int]]) -> Judgements | None:
    """Return one row per picked episode, with a column for every formula in any sample.

    A picked episode is a pair: the index of a sample, and the episode's row in it. Entries are NaN for formulas that
    the sample does not have.
    """
    return _united([one.judgements for one in samples], picked)


def _united(have: Sequence[Judgements | None], picked: Sequence[tuple[int, int]]) -> Judgements | None:
    names = tuple(sorted({name for one in have if one is not None for name in one.formulas}))
    if not names:
        return None
    column = {name: i for i, name in enumerate(names)}
    robustness, lost = (np.full((len(picked), len(names)), np.nan) for _ in range(2))
    for row, (which, local) in enumerate(picked):
        one = have[which]
        if one is not None:
            places = [column[name] for name in one.formulas]
            robustness[row, places] = one.robustness[local]
            lost[row, places] = one.lost[local]
    return Judgements(names, robustness, lost)


def world(judged: Judgements | None, formula: str) -> FormulaWorld | None:
    """Summarise a formula over the episodes that judged it; return None if there are none."""
    if judged is None or formula not in judged.formulas:
        return None
    column = judged.formulas.index(formula)
    values, lost = judged.robustness[:, column], judged.lost[:, column]
    known = ~np.isnan(values)
    if not known.any():
        return None
    violated = known & (values <= 0)
    return FormulaWorld(
        robustness=float(values[known].mean()),
        least=float(values[known].min()),
        episodes=int(known.sum()),
        violated=int(violated.sum()),
        first=float(lost[violated].min()) if violated.any() else None,
    )


def rows(order: Iterable[str], worlds: Mapping[str, Judgements | None]) -> tuple[FormulaRow, ...]:
    """Return one row per formula: those in `order` first, then the other formulas of the worlds."""
    others = sorted({name for one in worlds.values() if one is not None for name in one.formulas})
    found = []
    for formula in dict.fromkeys((*order, *others)):
        known = {name: summed for name, one in worlds.items() if (summed := world(one, formula)) is not None}
        found.append(FormulaRow(formula, known))
    return tuple(found)


def with_worlds(
    known: Sequence[FormulaRow], worlds: Mapping[str, Sequence[Sequence[Judged]]]
) -> tuple[FormulaRow, ...]:
    """Add results in further worlds to each formula's row; `worlds` has the results by world and episode."""
    summed = {name: stacked(episodes) for name, episodes in worlds.items()}
    return tuple(
        replace(
            row,
            worlds={
                **row.worlds,
                **{
                    name: found
                    for name, one in summed.items()
                    if (found := world(one, row.formula)) is not None
                },
            },
        )
        for row in known
    )


def stacked(episodes: Iterable[Sequence[Judged]]) -> Judgements | None:
    """Return the rows of several episodes, without those that have no results."""
    found = [one for one in map(judgements, episodes) if one is not None]
    return _united(found, [(i, 0) for i in range(len(found))])


def accounts(judged: Judgements | None) -> tuple[str, ...]:
    """Return one line per formula that summarises one world's episodes."""
    lines = []
    for name in judged.formulas if judged is not None else ():
        one = world(judged, name)
        if one is not None:
            broken = f", violated in {one.violated} of {one.episodes}" if one.violated else ""
            lines.append(f"{name}: robustness {margin(one.robustness)}, at least {margin(one.least)}{broken}")
    return tuple(lines)


def never_judged(judged: Judgements | None) -> tuple[str, ...]:
    """Return the formulas that were never judged, because every episode was too short."""
    if judged is None:
        return ()
    columns = enumerate(judged.formulas)
    return tuple(name for i, name in columns if np.isnan(judged.robustness[:, i]).all())
