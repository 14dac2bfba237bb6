"""Draw the tornado chart as SVG: how much margin each direction alone loses."""

from __future__ import annotations

from html import escape

from pytest_tarl.stressing.findings import Curve, Stress
from pytest_tarl.stressing.map_figure import COLOURS
from pytest_tarl.stressing.mapping import importance, lost
from pytest_tarl.stressing.svg_text import INK, svg_text

# px; END is the space for the value at the end of a bar
BAR, GAP, LABEL, WIDTH, END = 22, 12, 150, 640, 60


def tornado(stress: Stress) -> str:
    """Return the chart: a bar for each end of each range, the most important range on top.

    Return an empty text if there are fewer than two ranges.
    """
    order = [*importance(stress.curves)]
    if len(order) < 2:
        return ""
    low = 8 + len(order) * (BAR + GAP)
    middle = LABEL + (WIDTH - LABEL) / 2
    unit = ((WIDTH - LABEL) / 2 - END) / max(1.0, *(lost(curve) for curve in stress.curves))
    drawn = [
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {low + 50}" role="img" '
            f'aria-label="{escape(tornado_words(stress))}" style="background: #fff">'
        )
    ]
    for number, name in enumerate(order):
        y = 8 + number * (BAR + GAP)
        drawn.append(svg_text(LABEL - 12, y + BAR - 6, name, "end", bold=True))
        for curve in stress.curves:
            if curve.ray.names == (name,):
                drawn += _bar(curve, middle, unit, y)
    for side in (-1, 0, 1):
        x, dash = middle + side * unit, ' stroke-dasharray="4"' if side else ""
        drawn.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="2" y2="{low}" stroke="{INK}"{dash}/>')
        drawn.append(svg_text(x, low + 16, "limit" if side else "nominal", "middle"))
    drawn.append(svg_text(middle - 8, low + 38, "← lower values", "end"))
    drawn.append(svg_text(middle + 8, low + 38, "higher values →", "start"))
    return "\n".join([*drawn, "</svg>"])


def _bar(curve: Curve, middle: float, unit: float, y: float) -> list[str]:
    """Return the bar for one end of a range, labelled with the value of that end."""
    up = curve.ray.value(1.0) > curve.ray.value(0.0)
    length = max(lost(curve), 0.0) * unit
    colour = COLOURS["fails" if lost(curve) > 1.0 else "holds"]
    x, end = (middle, middle + length + 6) if up else (middle - length, middle - length - 6)
    return [
        f'<rect x="{x:.1f}" y="{y}" width="{max(length, 1.0):.1f}" height="{BAR}" fill="{colour}" stroke="{INK}"/>',
        svg_text(end, y + BAR - 6, f"{curve.ray.value(1.0):.3g}", "start" if up else "end"),
    ]


def tornado_words(stress: Stress) -> str:
    """Return the text alternative of the tornado chart."""
    parts = []
    for name in importance(stress.curves):
        ends = [
            f"{lost(curve):.2g} up to {curve.ray.value(1.0):.3g}"
            for curve in stress.curves
            if curve.ray.names == (name,)
        ]
        parts.append(f"{name}: {', '.join(ends)}")
    told = "; ".join(parts)
    return (
        "Largest loss of margin if only one direction changes; at a loss of 1, the dashed line, the guarantee is "
        f"just met. {told}."
    )
