"""Provide the data of the page's figures for its script."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from pytest_tarl.model import Comparison, ListComparison
from pytest_tarl.report.amounts import running_mean
from pytest_tarl.report.sensor_regions import Vocabulary, runs
from pytest_tarl.report.words import designed_world
from pytest_tarl.sensors import Cell, Sensor

if TYPE_CHECKING:
    from pytest_tarl.model import Matrix

MOST_ROWS = 6  # maximum number of rows (one per value of the sensor that splits the figure)
QUIET = 0.25  # minimum range of the scale for differences, as a share of the range of utilities
DIGITS = 5  # number of significant digits of numbers on the page


@dataclass(frozen=True, slots=True)
class Plane:
    """The sensors of a figure's axis and rows."""

    position: int
    split: int | None

    def others(self, sensors: Sequence[Sensor]) -> tuple[str, ...]:
        """Return the names of the sensors over which the figure averages."""
        return tuple(s.name for d, s in enumerate(sensors) if d not in (self.position, self.split))


def plane(comparison: Comparison) -> Plane:
    """Choose the first numeric sensor for the axis, and a category for the rows."""
    sensors = comparison.sensors
    position = next((d for d, sensor in enumerate(sensors) if sensor.numeric), 0)
    categories = [d for d, sensor in enumerate(sensors) if d != position and not sensor.numeric]
    return Plane(position, min(categories, key=lambda d: _covered(comparison, d), default=None))


def _covered(comparison: Comparison, dimension: int) -> float:
    """Return the share of a sensor's values that are in the region."""
    seen = {cell[dimension] for cell in comparison.cells}
    region = (*comparison.region.cells, *comparison.region.novel)
    return len({cell[dimension] for cell in region} & seen) / len(seen) if region and seen else 1.0


def utility_figure(comparison: Comparison, compared: ListComparison) -> dict[str, Any] | None:
    """Return the utilities and their difference by site and position; None if unvisited."""
    if not comparison.sensors or not comparison.cells:
        return None
    shown = plane(comparison)
    vocabulary = Vocabulary(comparison.sensors, comparison.cells)
    bins = _span(cell[shown.position] for cell in comparison.cells)
    rows = [
        _row(comparison, compared, shown, bins, value, vocabulary)
        for value in split_values(comparison, shown)
    ]
    low, high, reach = _extremes(rows)
    return {
        "sites": [[site.line, site.code, site.path] for site in compared.taint_list.sites],
        "axis": _axis(comparison.sensors[shown.position], shown.position, bins, vocabulary),
        "rows": rows,
        "range": [low, high],
        "reach": number(max(reach, QUIET * (high - low))),
    }


def split_values(comparison: Comparison, shown: Plane) -> Sequence[int | None]:
    """Return the values that get their own row, or [None]."""
    if shown.split is None:
        return [None]
    counted: dict[int, int] = {}
    for cell in comparison.cells:
        counted[cell[shown.split]] = counted.get(cell[shown.split], 0) + 1
    chosen = sorted(counted, key=lambda value: (-counted[value], value))[:MOST_ROWS]
    return sorted(chosen)


def _row(
    comparison: Comparison,
    compared: ListComparison,
    shown: Plane,
    bins: Sequence[int],
    value: int | None,
    vocabulary: Vocabulary,
) -> dict[str, Any]:
    here = [i for i, cell in enumerate(comparison.cells) if shown.split is None or cell[shown.split] == value]
    places = [comparison.cells[i][shown.position] for i in here]
    sensor = comparison.sensors[shown.position]

    def marked(cells: Iterable[Cell]) -> list[list[float]]:
        chosen = {c[shown.position] for c in cells if shown.split is None or c[shown.split] == value}
        return [list(_edges(sensor, first, last)) for first, last in runs((b, b) for b in chosen)]

    return {
        "title": "" if shown.split is None or value is None else vocabulary.bin(shown.split, value),
        "offline": _grid(compared.offline[here], places, bins),
        "online": _grid(compared.online[here], places, bins),
        "region": marked(comparison.region.cells),
        "paper": marked(comparison.paper_region),
        "novel": marked(comparison.region.novel),
    }


def _grid(values: Matrix, places: Sequence[int], bins: Sequence[int]) -> list[list[float | None]]:
    """Average the cells at each position, shape (sites, positions); None if none was visited."""
    column = np.asarray(places, dtype=np.intp) - bins[0]
    known = ~np.isnan(values)
    total = np.zeros((len(bins), values.shape[1]))
    count = np.zeros_like(total)
    np.add.at(total, column, np.where(known, values, 0.0))
    np.add.at(count, column, known)
    with np.errstate(invalid="ignore"):
        means = total / count
    return [[number(value) for value in row] for row in means.T.tolist()]


def _axis(sensor: Sensor, dimension: int, bins: Sequence[int], vocabulary: Vocabulary) -> dict[str, Any]:
    unit = f" ({sensor.unit})" if sensor.unit else ""
    return {
        "title": f"{sensor.name}{unit}",
        "centres": [number(sum(_edges(sensor, b, b)) / 2) for b in bins],
        "names": [vocabulary.bin(dimension, b) for b in bins],
        "ticks": None if sensor.numeric else [vocabulary.value(dimension, b) for b in bins],
        "outside": sensor.bins is not None and (bins[0] < 0 or bins[-1] >= sensor.bins),
    }


def _edges(sensor: Sensor, first: int, last: int) -> tuple[float, float]:
    """Return the axis's bin edges; bins without a limit are drawn one bin wide."""
    if not sensor.bins or sensor.low is None or sensor.high is None:
        return first - 0.5, last + 0.5
    width = (sensor.high - sensor.low) / sensor.bins
    return sensor.low + first * width, sensor.low + (last + 1) * width


def _span(indices: Iterable[int]) -> list[int]:
    found = set(indices)
    return list(range(min(found), max(found) + 1))


def _extremes(rows: Iterable[Mapping[str, Any]]) -> tuple[float, float, float]:
    """Return the lowest and highest utility shown, and the largest absolute difference."""
    values, changes = [], [0.0]
    for row in rows:
        for before, after in zip(chain(*row["offline"]), chain(*row["online"]), strict=True):
            values += [value for value in (before, after) if value is not None]
            if before is not None and after is not None:
                changes.append(abs(after - before))
    return min(values, default=0.0), max(values, default=0.0), max(changes)


def reward_curves(comparison: Comparison) -> list[dict[str, Any]]:
    """Return the running mean of the total reward for every curve."""
    drift = comparison.drift or "deployed"
    curves = [
        _curve("designed", "offline", comparison.totals.get("offline", ())),
        _curve(
            f"deployed ({drift})" if comparison.drift else drift,
            "online",
            comparison.totals.get("online", ()),
        ),
    ]
    curves += [_curve(f"search: {s.method}", "search", s.totals, s.labels) for s in comparison.searches]
    curves += [
        _curve("repaired", "repaired", comparison.totals.get("repaired", ())),
        _curve(
            f"repaired, {designed_world(comparison)}",
            "nominal",
            comparison.totals.get("nominal_repaired", ()),
        ),
    ]
    return [curve for curve in curves if curve["mean"]]


def _curve(name: str, kind: str, totals: Sequence[float], labels: Sequence[str] = ()) -> dict[str, Any]:
    return {
        "name": name,
        "kind": kind,
        "mean": [number(value) for value in running_mean(totals)],
        "totals": [number(value) for value in totals],
        "labels": list(labels),
    }


def number(value: float) -> float | None:
    """Return a number with DIGITS significant digits; None if it is not finite."""
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
