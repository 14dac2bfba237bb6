"""The tables of the benchmark, from its results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from statistics import fmean
from typing import Any

Result = Mapping[str, Any]
Answers = Mapping[str, Mapping[str, Any]]  # task → its answer


def tables(results: Mapping[str, Result], answers: Answers) -> str:
    """Return the comparison of the methods, and our own figures by task."""
    methods = list(dict.fromkeys(key.split("/")[0] for key in sorted(results, key=_ours_first)))
    rows = [row for method in methods for row in _rows(method, _of(results, method), answers)]
    slices = _slices(_of(results, "ours"), answers)
    return "\n".join(
        [*_head(COLUMNS), *rows[:1], *slices, *rows[1:], "", *_by_task(_of(results, "ours"), answers)]
    )


COLUMNS = (
    "method",
    "right site first",
    "in first three",
    "drifted world restored",
    "both worlds restored",
    "accepted though wrong",
    "unrepairable: no patch",
    "search episodes",
    "comparison",
    "acceptance",
    "sum",
)
OUR_COLUMNS = (
    "task",
    "sites",
    "operands",
    "right sites",
    "first",
    "in first three",
    "both worlds restored",
    "search",
    "acceptance",
    "one repair",
)


def _head(columns: Sequence[str]) -> list[str]:
    return [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]


def _rows(method: str, found: Sequence[tuple[str, Result]], answers: Answers) -> list[str]:
    """Return the row of a method, or a row for each metric of a localiser, and the reasons for incomplete runs."""
    if not any("ranks" in result for _, result in found):
        return [_row(method, found, answers)]
    asked = [(task, result) for task, result in found if _repairable(answers[task])]
    metrics = dict.fromkeys(metric for _, result in asked for metric in result["ranks"])
    rows = []
    for metric in metrics:
        ranks = [result["ranks"].get(metric) for _, result in asked if result["ranks"]]
        first, third = (_share(rank is not None and rank <= most for rank in ranks) for most in (1, 3))
        runs = _mean(result["episodes"]["search"] for _, result in asked if result["ranks"])
        rows.append(
            f"| {method}, {metric} | {first} | {third} | – | – | – | – | {runs:.0f} | 0 | 0 | {runs:.0f} |"
        )
    failed = dict.fromkeys(result["failed"] for _, result in asked if result["failed"])
    for reason in failed:
        times = sum(result["failed"] == reason for _, result in asked)
        rows.append(f"| {method}, {times} times | {reason} |" + " |" * (len(COLUMNS) - 2))
    return rows


def _row(method: str, found: Sequence[tuple[str, Result]], answers: Answers) -> str:
    repairable = [(task, result) for task, result in found if _repairable(answers[task])]
    others = [result for task, result in found if not _repairable(answers[task])]
    spent = [
        _mean(result["episodes"].get(kind, 0) for _, result in repairable)
        for kind in ("search", "comparison", "acceptance")
    ]
    cells = [
        method,
        _share(_within(answers[task], result["ranked"], 1) for task, result in repairable)
        if method.startswith("ours")
        else "–",
        _share(_within(answers[task], result["ranked"], 3) for task, result in repairable)
        if method.startswith("ours")
        else "–",
        _share(result["drifted restored"] for _, result in repairable),
        _share(both(result) for _, result in repairable),
        _share(result["accepted"] and not both(result) for _, result in found),
        _share(not result["accepted"] for result in others),
        *(f"{one:.0f}" for one in (*spent, sum(spent))),
    ]
    return f"| {' | '.join(cells)} |"


def _slices(found: Sequence[tuple[str, Result]], answers: Answers) -> list[str]:
    """Return the row of the slices, the final ranking of the paper's method."""
    ranked = [(task, result["slices"]) for task, result in found if _repairable(answers[task])]
    if not ranked:
        return []
    first, third = (_share(_within(answers[task], sites, most) for task, sites in ranked) for most in (1, 3))
    return [f"| utility slices, as in the paper | {first} | {third} | – | – | – | – | 0 | 40 | 0 | 40 |"]


def _by_task(found: Sequence[tuple[str, Result]], answers: Answers) -> list[str]:
    """Return our own figures by task."""
    rows = _head(OUR_COLUMNS)
    for task in dict.fromkeys(task for task, _ in found):
        seen, known = [result for name, result in found if name == task], answers[task]
        cells = [
            task,
            str(known.get("sites")),
            str(known.get("operands")),
            _right(known),
            _share(_within(answers[task], result["ranked"], 1) for result in seen),
            _share(_within(answers[task], result["ranked"], 3) for result in seen),
            _share(both(result) for result in seen),
            *(
                f"{_mean(result['episodes'].get(kind, 0) for result in seen):.0f}"
                for kind in ("search", "acceptance")
            ),
            _example(seen),
        ]
        rows.append(f"| {' | '.join(cells)} |")
    return rows


def _example(seen: Sequence[Result]) -> str:
    """Return the guard and the edits of an accepted repair as text, or why none was accepted."""
    last = next((result for result in seen if result["accepted"]), None)
    if last is None:
        return str(seen[0]["reason"])
    edits = "; ".join(edit.split(" ", 1)[1] for edit in last["edits"])
    return f"`{edits}` where `{last['guard']}`" if last["guard"] else f"`{edits}`"


def _right(known: Mapping[str, Any]) -> str:
    """Return, as text, the number of right sets of sites and the number of sites in each."""
    sets = known.get("right", [])
    return f"{len(sets)}" + (f" sets of {len(sets[0])}" if sets and len(sets[0]) > 1 else "")


def rank(sites: Sequence[str], answer: Mapping[str, Any]) -> int | None:
    """Return the rank of the first right set: 1 if its sites are at the top, None if no right set is ranked.

    If a set has several sites, all of them must be ranked before any other site.
    """
    places = {site: i for i, site in enumerate(sites)}
    ranks = [
        max(places[site] for site in right) + 2 - len(right)
        for right in answer.get("right", ())
        if all(site in places for site in right)
    ]
    return min(ranks, default=None)


def both(result: Result) -> bool:
    """Return whether a repair was accepted and works in both worlds (after a permanent drift, in the new one)."""
    nominal = result["nominal restored"] or result.get("permanent", False)
    return bool(result["accepted"] and result["drifted restored"] and nominal)


def _repairable(answer: Mapping[str, Any]) -> bool:
    return bool(answer["repairable"])


def _of(results: Mapping[str, Result], method: str) -> list[tuple[str, Result]]:
    return [(key.split("/")[1], result) for key, result in results.items() if key.split("/")[0] == method]


def _within(answer: Mapping[str, Any], sites: Sequence[str], most: int) -> bool:
    found = rank(sites, answer)
    return found is not None and found <= most


def _ours_first(key: str) -> tuple[bool, str]:
    return not key.startswith("ours/"), key


def _mean(values: Iterable[float]) -> float:
    kept = list(values)
    return fmean(kept) if kept else 0.0


def _share(values: Iterable[Any]) -> str:
    kept = [bool(value) for value in values]
    return f"{sum(kept)}/{len(kept)}"
