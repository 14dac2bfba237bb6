"""Write the fleet page: one self-contained HTML file that stays readable with ten thousand robots.

The page uses the styles of the report page (report/page/page.css). fleet.js draws the map, the timeline and the table
of robots from embedded JSON, which stores robots as columns of numbers.
"""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterator
from importlib import resources
from math import isnan, log2, sqrt
from pathlib import Path
from typing import Any

from pytest_tarl.errors import FleetError
from pytest_tarl.files import advice_on
from pytest_tarl.fleet import decomposition_words, repair_effect_words, words
from pytest_tarl.fleet.changed_robots import Robot, lower
from pytest_tarl.fleet.mission_groups import Group
from pytest_tarl.fleet.question import Answer
from pytest_tarl.fleet.residual_maps import ResidualMap
from pytest_tarl.report import html
from pytest_tarl.report.json_result import finite
from pytest_tarl.report.sensor_regions import Vocabulary
from pytest_tarl.sensors import Cell
from tarl_lint.files import write_atomically

# maximum number of groups on the map: those that differ first, then those with the lowest reward
MOST_GROUPS = 2000
MOST_CELLS = 12  # maximum number of cells listed for the fleet and for each robot
NAMES = 30  # maximum number of robots linked from a cluster
TAGS = {"helps": "helps", "harms": "harms"}


def write(answer: Answer, path: Path) -> None:
    """Write the page. Raise TarlError if jinja2 is missing or the file cannot be written."""
    text = render(answer)
    try:
        write_atomically(path, text.encode(), parents=True)
    except OSError as problem:
        raise FleetError(
            f"The page {path} cannot be written ({problem.strerror or problem}): {advice_on(problem)}"
        ) from problem


def render(answer: Answer) -> str:
    """Return the page as HTML. Raise TarlError if jinja2 is missing."""
    environment = html.environment(_asset, ("jinja2",))
    template = environment.get_template("fleet.html")
    vocabulary = Vocabulary(answer.fixture.sensors, answer.cells)
    return str(
        template.render(
            **_context(answer, vocabulary),
            css=html.asset("page.css") + _asset("fleet.css"),
            script=_asset("fleet.js"),
            data=html.in_script(_data(answer, vocabulary)),
        )
    )


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath("page").joinpath(name).read_text("utf-8")


def _context(answer: Answer, vocabulary: Vocabulary) -> dict[str, Any]:
    """Return the variables of the template."""
    question, found = answer.question, answer.robots
    named = {one.name for one in (*found.drifted, *found.below)}
    differing = sum(_differs(one) or watched.name in _changed(answer) for one, watched in _groups(answer))
    first, last = answer.period
    return {
        "title": question.data + (f", {question.robot}" if question.robot else ""),
        "test": answer.fixture.test,
        "headline": _headline(differing, len(answer.groups), len(named), len(found.every)),
        "missions": answer.missions,
        "period": f"{words.time(first)[:10]} to {words.time(last)[:10]}" if first else "no time",
        "robots": len(found.every),
        "episodes": answer.fixture.sample.episodes,
        "differing": differing,
        "groups": len(answer.groups),
        "by": ", ".join(question.by),
        "named": len(named),
        "rate": f"{100 * found.q:g} %",
        "onsets": (
            "Each column counts the named robots whose missions began to differ at that time. Each line marks a "
            "changed group."
        ),
        "clusters": [
            _cluster(one.robots, one.cells, one.residuals, vocabulary) for one in answer.clusters.found
        ],
        "lowest": [
            {
                "time": words.time(one.time),
                "result": "passed" if one.passed else "failed",
                "total": f"{one.total:.6g}",
                "steps": one.steps,
            }
            for one in answer.lowest
        ],
        "components": list(_components(answer)),
        "repairs": list(_repairs(answer)),
        "formulas": [
            {
                "formula": one.formula,
                "group": " ".join(group.values),
                "violated": f"{one.violated:,} of {one.missions:,}",
                "least": f"{one.least:.3g}",
            }
            for group in answer.groups
            for one in group.formulas
        ],
        "notes": [line.removeprefix("note: ") for line in words.notes(answer)],
    }


def _headline(differing: int, groups: int, named: int, robots: int) -> str:
    parts = []
    if groups > 1 or differing:
        parts.append(
            f"{differing:,} of {groups:,} group{'s' if groups != 1 else ''} differ from the recording"
        )
    parts.append(f"{named:,} of {robots:,} robot{'s' if robots != 1 else ''} named")
    return "; ".join(parts) + "."


def _cluster(
    robots: tuple[str, ...], cells: tuple[Cell, ...], residuals: tuple[float, ...], vocabulary: Vocabulary
) -> dict[str, Any]:
    return {
        "count": len(robots),
        "names": robots[:NAMES],
        "more": max(0, len(robots) - NAMES),
        "where": vocabulary.words(cells) if cells else "no common cell",
        "residual": f"{sum(residuals) / len(residuals):+.3g}" if residuals else "",
    }


def _components(answer: Answer) -> Iterator[dict[str, Any]]:
    parts = answer.parts
    if parts is None:
        return
    total = parts.total
    for one, levels in zip(parts.components, (*parts.levels, (), ()), strict=True):
        problem = decomposition_words.problem(one)
        known = not isnan(one.variance) and one.levels > 1
        share = 100 * max(0.0, one.variance) / total if known and total > 0 else 0.0
        yield {
            "name": decomposition_words.name(one, parts),
            "share": f"{share:.1f} %" if known else "",
            "width": round(share, 2),
            "variance": f"{max(0.0, one.variance):.3g}" if known else "",
            "interval": problem or f"{one.low:.3g} to {one.high:.3g}",
            "lowest": decomposition_words.lowest(one, levels),
        }


def _repairs(answer: Answer) -> Iterator[dict[str, Any]]:
    for one in answer.repairs:
        known = one.strata > 0
        yield {
            "repair": one.repair,
            "accepted": answer.accepted.get(one.repair, ""),
            "group": " ".join(one.values) or "all missions",
            "verdict": one.verdict,
            "tag": TAGS.get(one.verdict, "no-difference"),
            "reward": f"{one.reward:+.3g}" if known else "",
            "interval": repair_effect_words.interval(one.reward_bound, 1)
            or repair_effect_words.WHY.get(one.verdict, ""),
            "success": f"{100 * one.success:+.1f} points" if known else "",
            "missions": f"{one.missions[0]:,} with, {one.missions[1]:,} without",
        }


def _data(answer: Answer, vocabulary: Vocabulary) -> dict[str, Any]:
    """Return the data of the page (times in s since 1970, evidence as log2 of e-values)."""
    every = answer.robots.every
    number = {one.name: n for n, one in enumerate(every)}
    named = {one.name: one for one in (*answer.robots.below, *answer.robots.drifted)}
    return {
        "by": list(answer.question.by),
        "recorded": round(float(answer.fixture.sample.total.mean()), 6),
        "period": list(answer.period),
        "weak": round(-log2(answer.robots.q), 3),
        "command": shlex.join(["tarl", "fleet", answer.question.data]),
        "groups": _shown(answer, vocabulary),
        "cells": _cells(answer, list(named.values()), vocabulary),
        "robots": {
            "name": [one.name for one in every],
            "missions": [one.missions for one in every],
            "passed": [one.passed for one in every],
            "world": [round(one.world, 2) for one in every],
            "bound": [round(one.bound, 2) for one in every],
        },
        "named": [
            {"index": number[name], **_named(answer, named[name], vocabulary)}
            for name in sorted(named, key=number.__getitem__)
        ],
    }


def _groups(answer: Answer) -> list[tuple[Group, Robot]]:
    return list(zip(answer.groups, answer.onsets.every, strict=True))


def _differs(one: Group) -> bool:
    return one.verdict is not None and one.verdict.result != "no difference"


def _changed(answer: Answer) -> set[str]:
    return {one.name for one in (*answer.onsets.drifted, *answer.onsets.below)}


def _shown(answer: Answer, vocabulary: Vocabulary) -> list[dict[str, Any]]:
    """Return the groups on the map, in their order."""
    changed = _changed(answer)
    pairs = list(enumerate(_groups(answer)))
    pairs.sort(key=lambda pair: (not (_differs(pair[1][0]) or pair[1][1].name in changed), pair[1][0].reward))
    return [
        _group(one, watched, watched.name in changed, vocabulary)
        for _, (one, watched) in sorted(pairs[:MOST_GROUPS], key=lambda pair: pair[0])
    ]


def _group(one: Group, watched: Robot, changed: bool, vocabulary: Vocabulary) -> dict[str, Any]:
    cells = (*one.region.cells, *one.region.novel) or (
        watched.status.cells if changed and watched.status else ()
    )
    return {
        "values": list(one.values),
        "missions": one.missions,
        "robots": one.robots,
        "pass": one.passed / one.missions,
        "passLow": one.success.low,
        "passHigh": one.success.high,
        "reward": one.reward,
        "low": finite(one.mean.low),
        "high": finite(one.mean.high),
        "result": one.verdict.result if one.verdict else None,
        "verdict": words.verdict(one),
        "found": _differs(one) or changed,
        "named": changed,
        "evidence": round(max(watched.world, watched.bound), 2),
        "since": (_since(watched) or (0, 0.0))[1] if changed else None,
        "where": vocabulary.words(cells) if cells else "",
    }


def _since(one: Robot) -> tuple[int, float] | None:
    """Return the mission and time of the onset, from the test with more evidence."""
    if one.status is None:
        return None
    below = lower(one.status)
    evidence = below if below is not None and one.bound >= one.world else one.status.world
    return None if evidence.since is None else (evidence.since.mission, evidence.since.time or 0.0)


def _named(answer: Answer, one: Robot, vocabulary: Vocabulary) -> dict[str, Any]:
    onset = _since(one)
    like = next((group.robots for group in answer.clusters.found if one.name in group.robots), ())
    cells = _differing(answer, one)
    return {
        "mission": onset[0] if onset else None,
        "time": onset[1] if onset else None,
        "where": vocabulary.words(cells) if cells else "",
        "like": [name for name in like if name != one.name][:NAMES],
        "cells": _residuals(answer, answer.clusters.maps.get(one.name), vocabulary),
    }


def _differing(answer: Answer, one: Robot) -> tuple[Cell, ...]:
    """Return the cells in which a robot differs, from its status or its cluster."""
    if one.status is not None and one.status.cells:
        return one.status.cells
    return next((group.cells for group in answer.clusters.found if one.name in group.robots), ())


def _residuals(answer: Answer, found: ResidualMap | None, vocabulary: Vocabulary) -> list[dict[str, Any]]:
    """Return the cells with the largest residuals, in standard errors."""
    if found is None:
        return []
    rows = [
        (mean, sqrt(variance), cell)
        for mean, variance, cell in zip(
            found.mean.tolist(), found.variance.tolist(), answer.cells, strict=False
        )
        if variance > 0
    ]
    rows.sort(key=lambda row: -abs(row[0]) / row[1])
    return [
        {"name": vocabulary.words([cell]), "mean": float(f"{mean:.4g}"), "error": float(f"{error:.3g}")}
        for mean, error, cell in rows[:MOST_CELLS]
    ]


def _cells(answer: Answer, named: list[Robot], vocabulary: Vocabulary) -> list[dict[str, Any]]:
    """Return the cells in which most of the named robots and groups differ."""
    changed = _changed(answer)
    robots = Counter(cell for one in named for cell in _differing(answer, one))
    groups = Counter(
        cell
        for one, watched in _groups(answer)
        for cell in {
            *(one.region.cells if _differs(one) else ()),
            *(watched.status.cells if watched.name in changed and watched.status else ()),
        }
    )
    order = sorted({*robots, *groups}, key=lambda cell: (-robots[cell] - groups[cell], cell))
    return [
        {"name": vocabulary.words([cell]), "robots": robots[cell], "groups": groups[cell]}
        for cell in order[:MOST_CELLS]
    ]
