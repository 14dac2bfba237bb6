"""Write the result for other tools: one versioned JSON document per comparison (see `result.schema.json`)."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from pytest_tarl.errors import TarlError
from pytest_tarl.files import advice_on
from pytest_tarl.model import (
    Attempt,
    Bound,
    Comparison,
    Culprit,
    FormulaRow,
    Guarantee,
    Partial,
    Repair,
    SitePlace,
    Slice,
)
from pytest_tarl.report.amounts import atr, expected
from pytest_tarl.report.drift_sizes import rows as size_rows
from pytest_tarl.report.sensor_regions import boxes
from pytest_tarl.sensors import Cell, Sensor
from tarl_lint.files import write_atomically

FORMAT_VERSION = 1  # 1: first version
COUNTED = ("offline", "online", "search", "acceptance")
WORLDS = ("offline", "online", "repaired", "nominal_repaired")


def write(comparison: Comparison, path: Path, episodes: Mapping[str, int]) -> None:
    """Write the result; `episodes` has the number of episodes by kind: offline, online, search, acceptance.

    Raises:
        TarlError: the file cannot be written.
    """
    text = json.dumps(document(comparison, episodes), indent=1, ensure_ascii=False, allow_nan=False)
    try:
        write_atomically(path, f"{text}\n".encode(), parents=True)
    except OSError as error:
        raise TarlError(
            f"The result {path} cannot be written ({error.strerror or error}): {advice_on(error)}"
        ) from error


def schema() -> dict[str, Any]:
    """Return the JSON schema of the document."""
    text = resources.files(__package__).joinpath("result.schema.json").read_text("utf-8")
    loaded: dict[str, Any] = json.loads(text)
    return loaded


def document(comparison: Comparison, episodes: Mapping[str, int]) -> dict[str, Any]:
    """Return the result as plain values; numbers that are not finite become null."""
    verdict, repair = comparison.verdict, comparison.repair
    return {
        "format": FORMAT_VERSION,
        "test": comparison.test,
        "drift": comparison.drift,
        "seed": comparison.seed,
        "episodes": {name: int(episodes.get(name, 0)) for name in COUNTED},
        "atr": {world: finite(atr(comparison, world)) for world in WORLDS},
        "verdict": {
            "result": verdict.result,
            "p_drift": finite(verdict.p_drift),
            "p_loss": finite(verdict.p_loss),
            "loss": finite(verdict.loss),
            "p_failures": finite(verdict.p_failures),
            "success": {"offline": finite(verdict.success[0]), "online": finite(verdict.success[1])},
            "because": list(verdict.because),
            "detectable_loss": finite(verdict.detectable_loss),
        },
        "bounds": {
            world: _guarantee(comparison.stated.get(world))
            for world in ("offline", "repaired", "nominal_repaired")
        },
        "region": rectangles(comparison.region.cells, comparison.sensors),
        "novel": rectangles(comparison.region.novel, comparison.sensors),
        "no_longer_visited": rectangles(comparison.region.left, comparison.sensors),
        "sites": [
            _site(one) for one in _widest(one for compared in comparison.lists for one in compared.slices)
        ],
        "culprits": [_culprit(culprit) for culprit in comparison.culprits],
        "repair": _repair(repair) if repair else None,
        **({"formulas": [_formula(row) for row in comparison.formulas]} if comparison.formulas else {}),
        **({"notes": list(comparison.notes)} if comparison.notes else {}),
        **({"sizes": _sizes(comparison)} if comparison.sizes else {}),
    }


def _sizes(comparison: Comparison) -> list[dict[str, Any]]:
    """Return the mean reward for each world and each interval of a drift's ranges."""
    return [
        {
            "part": row.band.part,
            "low": row.band.low,
            "high": row.band.high,
            "online": finite(row.before),
            "repaired": finite(row.after),
        }
        for row in size_rows(comparison)
    ]


def rectangles(cells: Iterable[Cell], sensors: Sequence[Sensor]) -> list[dict[str, list[Any]]]:
    """Cover cells with rectangles.

    Each rectangle maps sensor names to closed intervals in the sensor's units; a missing limit is null. For a sensor
    with text categories, both ends are the same category.
    """
    texts = [d for d, sensor in enumerate(sensors) if sensor.categories]
    return [
        {sensor.name: _interval(sensor, *ends) for sensor, ends in zip(sensors, box, strict=True)}
        for box in boxes(cells, apart=texts)
    ]


def _interval(sensor: Sensor, first: int, last: int) -> list[Any]:
    if sensor.categories:
        return [sensor.categories[first], sensor.categories[last]]
    if not sensor.numeric:
        return [first, last]
    return [finite(round(end, 9)) for end in sensor.interval(first, last)]


def _widest(slices: Iterable[Slice]) -> list[Slice]:
    """Return the largest slice of each site, in order of appearance."""
    kept: dict[str, Slice] = {}
    for one in slices:
        held = kept.get(one.site.id)
        if held is None or _size(one) > _size(held):
            kept[one.site.id] = one
    return list(kept.values())


def _size(one: Slice) -> float:
    return -1.0 if math.isnan(one.difference) else abs(one.difference)


def _place(site: SitePlace) -> dict[str, Any]:
    return {"site": site.id, "path": site.path, "line": site.line}


def _site(one: Slice) -> dict[str, Any]:
    figures = {"offline": one.offline, "online": one.online, "difference": one.difference}
    return {
        **_place(one.site),
        "code": one.site.code,
        **{name: finite(value) for name, value in figures.items()},
    }


def _culprit(culprit: Culprit) -> dict[str, Any]:
    operands = [
        {
            "code": one.code,
            "value": finite(one.value),
            "best": finite(expected(one.best)),
            "effect": finite(one.effect),
            **({"what": one.what} if one.what else {}),
        }
        for one in culprit.operands
    ]
    evidence = {"score": finite(culprit.score), "method": culprit.method, "operands": operands}
    return {**_place(culprit.site), **evidence}


def _formula(row: FormulaRow) -> dict[str, Any]:
    worlds = {
        name: {
            "robustness": finite(world.robustness),
            "least": finite(world.least),
            "episodes": world.episodes,
            "violated": world.violated,
            "first_violation": finite(world.first),
        }
        for name, world in row.worlds.items()
    }
    return {"formula": row.formula, "worlds": {name: worlds.get(name) for name in WORLDS}}


def _repair(repair: Repair) -> dict[str, Any]:
    edits = [
        {
            "path": edit.path,
            "line": edit.line,
            "code": edit.code,
            "value": finite(edit.value),
            **({"what": edit.what} if edit.what else {}),
        }
        for edit in repair.edits
    ]
    tried = [_tried(attempt) for attempt in repair.history]
    return {
        "accepted": repair.accepted,
        "guard": repair.guard,
        "patch": repair.patch or None,
        "edits": edits,
        "tried": tried,
        **({"partial": _partial(repair.partial)} if repair.partial else {}),
    }


def _partial(partial: Partial) -> dict[str, Any]:
    return {
        "what": partial.what,
        "patch": partial.patch,
        "gain": finite(partial.gain),
        "low": finite(partial.low),
        "designed": finite(partial.designed),
        "designed_low": finite(partial.designed_low),
    }


def _tried(attempt: Attempt) -> dict[str, Any]:
    """Return a repair candidate and its outcome as plain values."""
    return {
        "what": attempt.what,
        "reason": attempt.reason or None,
        "mean": finite(attempt.mean),
        "episodes": attempt.episodes,
        "fresh": attempt.fresh,
    }


def _guarantee(stated: Guarantee | None) -> dict[str, Any] | None:
    if stated is None:
        return None
    quantile = {"share": stated.share, "low": finite(stated.quantile), "episodes": stated.needed}
    return {
        "episodes": stated.episodes,
        "varied": stated.varied,
        "success": _bound(stated.success),
        "mean": _bound(stated.mean),
        "quantile": quantile,
    }


def _bound(bound: Bound) -> dict[str, Any]:
    return {
        "low": finite(bound.low),
        "high": finite(bound.high),
        "confidence": bound.confidence,
        "method": bound.method,
        "exact": bound.exact,
    }


def finite(value: float | None) -> float | None:
    """Return a number for JSON; None for NaN and infinities."""
    if value is None or not math.isfinite(value):
        return None
    return value if isinstance(value, int) else float(value)
