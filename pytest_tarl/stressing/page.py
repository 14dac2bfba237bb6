"""The report page of a stress test: a single file without scripts, with sentences, figures and tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from html import escape
from itertools import groupby

from pytest_tarl.spaces import Span, nominal
from pytest_tarl.stressing.findings import Curve, Stress
from pytest_tarl.stressing.guarantee import Evidence
from pytest_tarl.stressing.map_figure import map_figure, map_words
from pytest_tarl.stressing.tornado_figure import tornado, tornado_words
from pytest_tarl.stressing.words import (
    broken_promises,
    budget_words,
    directions,
    ended_words,
    guarantee_words,
    nominal_words,
    repair_lines,
    shown,
    sobol_words,
    statement_words,
    together,
    undecided_promises,
)

WIDTH, HEIGHT, EDGE = 640, 200, 44  # px; EDGE is the space for the axes
TOP, BOTTOM = 1.25, -1.25  # range of margins in the figure; margins outside it are drawn at its edge
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; color: #1c2333 }
h1 { font-size: 1.4rem } h2 { font-size: 1.1rem; margin-top: 2rem } svg { width: 100%; height: auto }
text { font: 12px system-ui, sans-serif; fill: #4a5265 } table { border-collapse: collapse; font-size: .9rem }
td, th { padding: .1rem .8rem .1rem 0; text-align: right } .broken { color: #b3261e; font-weight: 600 }
.code { text-align: left }
@media (prefers-color-scheme: dark) { body { background: #14171f; color: #e6e9f0 } text { fill: #aab2c5 } }
"""
LEGEND = (
    "Each curve shows the margin over the values of a direction: it is 1 as designed and 0 where the guarantee is just "
    "met. The guarantee holds at green values and fails at red ones; brown ones are undecided. Each boundary lies in a "
    "shaded part."
)
COLOURS = {"fails": "#b3261e", "holds": "#1f7a4d", "open": "#8a6d00"}


def render(stress: Stress) -> str:
    """Return the page as HTML."""
    title = escape(f"Stress of {stress.test}, {stress.drift}")
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>',
            f"<h1>{title}</h1>",
            *(f"<p>{escape(one)}</p>" for one in _opening(stress)),
            *(f'<p class="broken">{escape(one)}</p>' for one in broken_promises(stress)),
            *(f"<p>must_hold: {escape(one)}</p>" for one in undecided_promises(stress)),
            *_maps(stress),
            *_sections(stress),
            *_combinations(stress),
            *_repairs(stress),
            *_statements(stress),
            *_variance(stress),
            "</html>\n",
        ]
    )


def _opening(stress: Stress) -> Iterator[str]:
    yield f"{guarantee_words(stress)} {stress.episodes} episodes, budget {budget_words(stress)}, seed {stress.seed}."
    if stress.ended == "nominal":
        yield nominal_words()
    yield from ended_words(stress)
    yield LEGEND


def _maps(stress: Stress) -> Iterator[str]:
    """Yield the tornado chart and the map, each with its text alternative."""
    chart, drawn = tornado(stress), map_figure(stress)
    if chart:
        yield f"<h2>Directions</h2><p>{escape(tornado_words(stress))}</p>{chart}"
    if drawn:
        yield f"<h2>Map</h2><p>{escape(map_words(stress))}</p>{drawn}"


def _sections(stress: Stress) -> Iterator[str]:
    """Yield a section for each direction: sentences, curve, numbers."""
    sentences = dict(directions(stress))
    for name, curves in groupby(stress.curves, key=lambda curve: curve.ray.names[0]):
        own = list(curves)
        yield f"<h2>{escape(name)}</h2>"
        yield from (f"<p>{escape(one)}</p>" for one in sentences[name])
        extent = stress.space.extents[name]
        points = {curve.ray.value(t): one for curve in own for t, one in curve.evidence.items()}
        measured = [(value, points[value]) for value in sorted(points)]
        if isinstance(extent, Span) and measured:
            yield _figure(name, extent, own, measured)
        yield _table(stress, name, measured)


def _figure(name: str, extent: Span, curves: list[Curve], measured: list[tuple[float, Evidence]]) -> str:
    """Return an SVG plot of the margin against the values of one direction."""

    def x(value: float) -> float:
        return EDGE + (WIDTH - 2 * EDGE) * (value - extent.low) / (extent.high - extent.low)

    def y(margin: float) -> float:
        return 10 + (HEIGHT - 40) * (TOP - min(max(margin, BOTTOM), TOP)) / (TOP - BOTTOM)

    usual = nominal(extent)
    line = sorted([*((value, one.margin) for value, one in measured), (usual, 1.0)])
    found = [curve for curve in curves if curve.boundary is not None]
    drawn = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="margin over {escape(name)}">',
        *(_band(curve, x) for curve in found),
        f'<line x1="{EDGE}" x2="{WIDTH - EDGE}" y1="{y(0):.1f}" y2="{y(0):.1f}" stroke="#888" stroke-dasharray="4"/>',
        '<polyline fill="none" stroke="#3346d3" stroke-width="1.5" points="'
        + " ".join(f"{x(value):.1f},{y(margin):.1f}" for value, margin in line)
        + '"/>',
        *(
            f'<circle cx="{x(value):.1f}" cy="{y(one.margin):.1f}" r="4" fill="{COLOURS[one.result]}">'
            f"<title>{value:.3g}: margin {one.margin:.2g}, {one.passed} of {one.episodes} passed</title></circle>"
            for value, one in measured
        ),
        *(
            f'<text x="{x(value):.1f}" y="{HEIGHT - 8}" text-anchor="middle">{value:.3g}</text>'
            for value in sorted({extent.low, usual, extent.high})
        ),
        *(
            f'<text x="{EDGE - 6}" y="{y(margin) + 4:.1f}" text-anchor="end">{margin:g}</text>'
            for margin in (1, 0, -1)
        ),
        "</svg>",
    ]
    return "\n".join(drawn)


def _band(curve: Curve, x: Callable[[float], float]) -> str:
    """Return the interval of a boundary as a rectangle, or an empty text if there is no boundary."""
    boundary = curve.boundary
    if boundary is None:
        return ""
    left, right = sorted((x(curve.ray.value(boundary.near or 0.0)), x(curve.ray.value(boundary.far))))
    return f'<rect x="{left:.1f}" y="10" width="{max(right - left, 1):.1f}" height="{HEIGHT - 40}" fill="#b3261e22"/>'


def _table(stress: Stress, name: str, measured: list[tuple[float, Evidence]]) -> str:
    rows = [
        f"<tr><td>{escape(shown(stress.space.extents[name], value))}<td>{one.margin:.2f}<td>{one.result}"
        f"<td>{one.passed} of {one.episodes}<td>{one.loss:.3g}"
        for value, one in measured
    ]
    head = f"<tr><th>{escape(name)}<th>margin<th>guarantee<th>passed<th>loss"
    return f"<details><summary>All values</summary><table>{head}{''.join(rows)}</table></details>"


def _repairs(stress: Stress) -> Iterator[str]:
    """Yield the result of each repair search, with a table of the boundaries that the repair moves."""
    if stress.repairs is None:
        return
    yield "<h2>Repair</h2>"
    if not stress.repairs:
        yield "<p>No failure was confirmed, so nothing was repaired.</p>"
    for one in stress.repairs:
        yield from (f"<p>{escape(line)}</p>" for line in repair_lines(replace(stress, repairs=(one,))))
        if one.moved:
            rows = "".join(
                f"<tr><td>{escape(row.name)}<td>{escape(row.before)}<td>{escape(row.after)}<td>{row.change}"
                for row in one.moved
            )
            yield f"<table><tr><th>boundary<th>before<th>after<th>change{rows}</table>"
        if one.patch is not None:
            yield f"<p>Patch: <code>{escape(one.patch)}</code></p>"


def _statements(stress: Stress) -> Iterator[str]:
    """Yield the table of the statements that ran only in failing episodes."""
    found = stress.statements
    if found is None:
        return
    yield "<h2>Statements of failures</h2>"
    if not found.only:
        yield from (f"<p>{escape(one)}</p>" for one in statement_words(stress))
        return
    yield (
        f"<p>Each statement ran in some of the {found.failing} failing episodes that were repeated, and in none "
        f"of {found.others} other episodes.</p>"
    )
    rows = (
        f"<tr><td>{escape(one.path)}:{one.line}<td>{one.failing} of {found.failing}"
        f'<td class="code"><code>{escape(one.text)}</code>'
        for one in found.only
    )
    yield f"<table><tr><th>statement<th>failing episodes<th>{''.join(rows)}</table>"


def _variance(stress: Stress) -> Iterator[str]:
    """Yield the table of the Sobol indices."""
    if stress.sobol is None:
        return
    yield "<h2>Variance</h2>"
    yield from (f"<p>{escape(one)}</p>" for one in sobol_words(stress))
    rows = (
        f"<tr><td>{escape(one.name)}<td>{one.first:.2f} ± {one.first_error:.2f}"
        f"<td>{one.total:.2f} ± {one.total_error:.2f}"
        for one in sorted(stress.sobol.shares, key=lambda one: -one.total)
    )
    yield f"<table><tr><th>direction<th>alone<th>with combinations{''.join(rows)}</table>"


def _combinations(stress: Stress) -> Iterator[str]:
    sentences = list(together(stress))
    if sentences:
        yield "<h2>Combinations</h2>"
        yield from (f"<p>{escape(one)}</p>" for one in sentences)
