"""`tarl show FIXTURE`: summarize a recording on one screen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.judgements import accounts
from pytest_tarl.learning.tables import START, Floats, ListSample
from pytest_tarl.model import TaintList
from pytest_tarl.report.guarantee_words import percent, sentences
from pytest_tarl.sensors import Sensor

CODE = 60  # maximum characters of a line of code
FEW = 24  # maximum number of statements to list without --sites


def lines(fixture: Fixture, size: int, sizes: Sequence[int], *, every: bool = False) -> Iterator[str]:
    """Yield the summary of a recording of `size` bytes; `sizes` are the bytes of its taint lists.

    Statements are listed if there are few of them, or if `every` is true.
    """
    sample = fixture.sample
    yield f"{fixture.test}, seed {fixture.seed}"
    if fixture.design:
        yield f"  design     with the drift {' and '.join(fixture.design)}, permanent"
    yield f"  episodes   {sample.episodes}, {int(sample.steps.sum())} steps, success {percent(sample.passed.mean())}"
    lists = "list" if len(sizes) == 1 else "lists"
    yield f"  size       {_kilobytes(size)}, of which {_kilobytes(sum(sizes))} for {len(sizes)} taint {lists}"
    least, most = sample.total.min(), sample.total.max()
    yield f"  reward     {sample.total.mean():.4g} per episode, from {least:.4g} to {most:.4g}"
    for place, told in enumerate(sentences(fixture.stated) if fixture.stated else ()):
        yield f"  {'' if place else 'bounds':<11}{told}"
    for i, name in enumerate(sample.part_names):
        yield f"             {name} {sample.chain.parts[:, i].sum() / sample.episodes:.4g}"
    for i, line in enumerate(accounts(sample.judgements)):
        yield f"  {'' if i else 'formulas':<10} {line}"
    yield f"  cells      {len(sample.cells)}"
    for i, sensor in enumerate(fixture.sensors):
        yield f"             {described(sensor, [cell[i] for cell in sample.cells])}"
    statements = sum(len(one.sites) for one in fixture.lists)
    listed = every or statements <= FEW
    for taint_list, recorded, own in zip(fixture.lists, sample.lists, sizes, strict=True):
        yield from _list(taint_list, recorded, own) if listed else [_summary(taint_list, recorded, own)]
    if not listed:
        yield f"  tarl show --sites lists the {statements} statements of the {len(sizes)} taint lists."


def described(sensor: Sensor, bins: Sequence[int]) -> str:
    """Describe a sensor, and how many of its bins were visited."""
    origin = f"{sensor.topic} {sensor.field}" if sensor.topic else "observed"
    origin += f", node variable {sensor.expr}" if sensor.expr else ""
    if len(sensor.edges) == 1:
        kind = (
            f"below and above {sensor.edges[0]:g}{sensor.unit and ' ' + sensor.unit}, {len(set(bins))} seen"
        )
    elif sensor.numeric:
        unit = f" {sensor.unit}" if sensor.unit else ""
        kind = f"{sensor.low:g} to {sensor.high:g}{unit} in {sensor.bins} bins, {len(set(bins))} seen"
    else:
        kind = "seen " + ", ".join(sensor.label(index) for index in sorted(set(bins)))
    return f"{sensor.name}: {origin}, {kind}"


def _counts(recorded: ListSample) -> Floats:
    """Return how often each site was executed, shape (sites,)."""
    visits = recorded.visits
    events = visits.state != START
    site = (visits.state[events] - 1) % max(recorded.width, 1)
    return np.bincount(site, weights=visits.count[events], minlength=recorded.width).astype(float)


def _heading(taint_list: TaintList, recorded: ListSample, counts: Floats, size: int) -> str:
    return f"  {taint_list.name}: {int(counts.sum())} events, mean |f| {recorded.mean_flow:.4g}, {_kilobytes(size)}"


def _summary(taint_list: TaintList, recorded: ListSample, size: int) -> str:
    files = ", ".join(sorted({place.path for place in taint_list.sites}))
    return f"{_heading(taint_list, recorded, _counts(recorded), size)}, {len(taint_list.sites)} statements in {files}"


def _list(taint_list: TaintList, recorded: ListSample, size: int) -> Iterator[str]:
    counts = _counts(recorded)
    flows = recorded.flow.sum(axis=0)
    yield _heading(taint_list, recorded, counts, size)
    for place, count, flow in zip(taint_list.sites, counts.tolist(), flows.tolist(), strict=True):
        mean = flow / count if count else 0.0
        mark = "●" if place.dependence == "data" else "◆"
        code = " ".join(place.code.split())
        shown = code if len(code) <= CODE else f"{code[: CODE - 1]}…"
        yield f"    {place.path}:{place.line:<4} {mark} {shown:<{CODE}} {int(count):>7} × {mean:.4g}"


def _kilobytes(size: int) -> str:
    return f"{size / 1000:.1f} kB"
