"""Draw the map of predicted margins as SVG."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from pytest_tarl.spaces import nominal
from pytest_tarl.stressing.findings import Failure, MarginMap, Stress
from pytest_tarl.stressing.svg_text import INK, svg_text

# px: side length of the map, and the margins to the left, above and below
SIZE, LEFT, TOP, FOOT = 400, 90, 12, 130
COLOURS = {"holds": "#d5ecdf", "unsure": "#f3dfa2", "fails": "#e59a93"}  # light, so that dark marks stand out
NAMES = {"holds": "holds", "unsure": "undecided", "fails": "fails"}
SURE = 2.0  # a margin closer to 0 than this many standard deviations counts as undecided


def map_figure(stress: Stress) -> str:
    """Return the map as SVG with a text alternative, or an empty text if there is no map."""
    found = stress.margin_map
    if found is None:
        return ""
    drawn = [
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + SIZE + 20} {TOP + SIZE + FOOT}" role="img" '
            f'aria-label="{escape(map_words(stress))}" style="max-width: 34rem; background: #fff">'
        ),
        *_cells(found),
        *_marks(stress, found),
        *_axes(found),
        *_legend(),
        "</svg>",
    ]
    return "\n".join(drawn)


def map_words(stress: Stress) -> str:
    """Return the text alternative of the map."""
    found = stress.margin_map
    if found is None:
        return ""
    answers = [
        answer(*pair)
        for rows in zip(found.margins, found.spreads, strict=True)
        for pair in zip(*rows, strict=True)
    ]
    counts = {one: answers.count(one) / len(answers) for one in COLOURS}
    return (
        f"Predicted margin over {found.names[0]} and {found.names[1]}, with the other directions at their nominal "
        f"values: the guarantee holds in {counts['holds']:.0%} of the area, fails in {counts['fails']:.0%}, and is "
        f"undecided in {counts['unsure']:.0%}, where the boundary lies."
    ).replace("%", " %")


def answer(margin: float, spread: float) -> str:
    """Return the result for a cell: the guarantee "holds", "fails", or is undecided ("unsure")."""
    if abs(margin) < SURE * spread:
        return "unsure"
    return "holds" if margin > 0.0 else "fails"


def _cells(found: MarginMap) -> Iterator[str]:
    """Yield a rectangle for each run of equal cells in a row, and the predicted boundary."""
    count = len(found.margins)
    side = SIZE / count
    for row, (margins, spreads) in enumerate(zip(found.margins, found.spreads, strict=True)):
        answers = [answer(*pair) for pair in zip(margins, spreads, strict=True)]
        start = 0
        for column in range(1, count + 1):
            if column == count or answers[column] != answers[start]:
                yield (
                    f'<rect x="{LEFT + start * side:.1f}" y="{TOP + SIZE - (row + 1) * side:.1f}" '
                    f'width="{(column - start) * side + 0.3:.1f}" height="{side + 0.3:.1f}" '
                    f'fill="{COLOURS[answers[start]]}"/>'
                )
                start = column
    yield f'<path fill="none" stroke="{INK}" stroke-width="2" d="{_boundary(found)}"/>'


def _boundary(found: MarginMap) -> str:
    """Return an SVG path along the cell edges between margins above and below 0."""
    count = len(found.margins)
    side = SIZE / count
    edges = []
    for row in range(count):
        for column in range(count):
            here = found.margins[row][column] < 0.0
            x, y = LEFT + column * side, TOP + SIZE - row * side
            if column and here != (found.margins[row][column - 1] < 0.0):
                edges.append(f"M{x:.1f} {y:.1f}v{-side:.1f}")
            if row and here != (found.margins[row - 1][column] < 0.0):
                edges.append(f"M{x:.1f} {y:.1f}h{side:.1f}")
    return "".join(edges)


def _marks(stress: Stress, found: MarginMap) -> Iterator[str]:
    """Yield a ring at the nominal drift, and a cross at each confirmed failure in the plane of the map."""
    x, y = _place(found, dict(stress.space.nominal))
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#fff" stroke="{INK}" stroke-width="2"/>'
    for one in stress.failures:
        if _in_plane(one, found):
            x, y = _place(found, dict(one.point))
            yield f'<path stroke="{INK}" stroke-width="2.5" d="M{x - 5:.1f} {y - 5:.1f}l10 10m0 -10l-10 10"/>'


def _in_plane(one: Failure, found: MarginMap) -> bool:
    return set(one.names) <= set(found.names)


def _place(found: MarginMap, point: dict[str, float]) -> tuple[float, float]:
    shares = []
    for name, extent in zip(found.names, found.spans, strict=True):
        shares.append((point[name] - extent.low) / (extent.high - extent.low))
    return LEFT + SIZE * shares[0], TOP + SIZE * (1.0 - shares[1])


def _axes(found: MarginMap) -> Iterator[str]:
    """Yield the frame, the names of both directions, and their end and nominal values."""
    yield f'<rect x="{LEFT}" y="{TOP}" width="{SIZE}" height="{SIZE}" fill="none" stroke="{INK}"/>'
    for number, extent in enumerate(found.spans):
        for value in sorted({extent.low, nominal(extent), extent.high}):
            share = (value - extent.low) / (extent.high - extent.low)
            if number == 0:
                yield svg_text(LEFT + SIZE * share, TOP + SIZE + 20, f"{value:.3g}", "middle")
            else:
                yield svg_text(LEFT - 8, TOP + SIZE * (1.0 - share) + 4, f"{value:.3g}", "end")
    yield svg_text(LEFT + SIZE / 2, TOP + SIZE + 44, found.names[0], "middle", bold=True)
    middle = TOP + SIZE / 2
    yield (
        f'<g transform="rotate(-90 20 {middle})">{svg_text(20, middle, found.names[1], "middle", bold=True)}</g>'
    )


def _legend() -> Iterator[str]:
    y = TOP + SIZE + 66
    for number, (one, colour) in enumerate(COLOURS.items()):
        x = LEFT + 130 * number
        yield f'<rect x="{x}" y="{y}" width="16" height="16" fill="{colour}" stroke="{INK}"/>'
        yield svg_text(x + 24, y + 13, NAMES[one], "start")
    y += 40
    yield f'<path stroke="{INK}" stroke-width="2" d="M{LEFT} {y - 4}h18"/>'
    yield svg_text(LEFT + 24, y, "predicted boundary", "start")
    yield f'<circle cx="{LEFT + 168}" cy="{y - 4}" r="6" fill="#fff" stroke="{INK}" stroke-width="2"/>'
    yield svg_text(LEFT + 180, y, "nominal", "start")
    yield f'<path stroke="{INK}" stroke-width="2.5" d="M{LEFT + 255} {y - 9}l10 10m0 -10l-10 10"/>'
    yield svg_text(LEFT + 272, y, "confirmed failure", "start")
