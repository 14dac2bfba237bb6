"""Text elements of the SVG figures."""

from __future__ import annotations

from html import escape

INK = "#1c2333"  # colour of text and lines; contrast of at least 7 to every background in the figures


def svg_text(x: float, y: float, text: str, anchor: str, *, bold: bool = False) -> str:
    """Return a text element at (x, y) in px; `anchor` is start, middle or end."""
    weight = ";font-weight:600" if bold else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" '
        f'style="font:13px system-ui,sans-serif;fill:{INK}{weight}">{escape(text)}</text>'
    )
