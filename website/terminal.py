"""Run the tutorial and draw a recording of the terminal: docs/images/terminal.svg.

    python -m website.terminal

`python -m website.tutorial --write` also draws it if the tutorial's output has changed. Lines appear as they were
printed, but a command that takes longer than two seconds takes only two in the recording.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from website.page_commands import TUTORIAL, Ran, run
from website.pages import ROOT

TARGET = ROOT / "docs" / "images" / "terminal.svg"
SHOWN = ("tarl-lint", "pytest", "tarl apply", "git diff")  # prefixes of the commands to show
HIDDEN = ("tarl-lint --", "pytest -q\n")  # prefixes of commands that are hidden, although SHOWN includes them
COLUMNS, ROWS, LINE, CHARACTER, EDGE = 92, 30, 17, 7.4, 14
TYPED, PAUSE, LONGEST = 0.045, 1.2, 2.0  # pauses in s: per character, after a command's output, per command
STYLE = """text{font:12.3px ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;fill:#e6e6e6;white-space:pre;\
opacity:0;animation:show 1ms linear forwards}
.c{fill:#ffffff;font-weight:700}.a{fill:#7ee2a8}.r{fill:#ff9d94}.v{fill:#ffd479}
@keyframes show{to{opacity:1}}
@media (prefers-reduced-motion:reduce){text,#s{animation-delay:0s!important;animation-duration:1ms!important}}"""


class Line(NamedTuple):
    """A line of the terminal, its CSS class, and when it appears (s)."""

    text: str
    kind: str
    second: float


def kind(text: str) -> str:
    """Return the CSS class of an output line: `a` for added, `r` for removed, `v` for a verdict, or empty."""
    if text.startswith(("+", "applied")) or "accepted: " in text:
        return "a"
    if text.startswith(("-", "FAILED")) and not text.startswith("--write"):
        return "r"
    return "v" if text.startswith(("degraded", "  verdict", "  where")) else ""


def recorded(ran: Sequence[Ran]) -> list[Line]:
    """Return the lines of the recording in the order in which they appear."""
    lines, second = [], 0.5
    for one in ran:
        line = one.command.line
        if not line.startswith(SHOWN) or f"{line}\n".startswith(HIDDEN):
            continue
        lines.append(Line(f"$ {line}", "c", second))
        second += TYPED * len(line) + min(one.seconds, LONGEST)
        for text in one.printed.splitlines():
            lines.append(Line(text, kind(text), second))
            second += 0.03
        second += PAUSE
    return lines


def drawn(lines: Sequence[Line]) -> str:
    """Return an animated SVG picture of a scrolling terminal."""
    height = ROWS * LINE + 2 * EDGE
    width = round(COLUMNS * CHARACTER) + 2 * EDGE
    end = lines[-1].second + 0.1
    scrolls = [(line.second / end * 100, at + 1 - ROWS) for at, line in enumerate(lines) if at >= ROWS]
    frames = "".join(f"{percent:.3f}%{{transform:translateY({-LINE * rows}px)}}" for percent, rows in scrolls)
    last = -LINE * max(0, len(lines) - ROWS)
    texts = [
        f'<text x="{EDGE}" y="{EDGE + LINE * (at + 0.75):.1f}" class="{line.kind}" '
        f'style="animation-delay:{line.second:.2f}s">{escape(line.text)}</text>'
        for at, line in enumerate(lines)
        if line.text
    ]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}">',
            f"<style>{STYLE}\n#s{{animation:scroll {end:.1f}s step-end forwards}}",
            f"@keyframes scroll{{0%{{transform:none}}{frames}100%{{transform:translateY({last}px)}}}}</style>",
            f'<rect width="{width}" height="{height}" rx="8" fill="#1e1e24"/>',
            f'<clipPath id="w"><rect y="{EDGE / 2}" width="{width}" height="{height - EDGE}"/></clipPath>',
            '<g clip-path="url(#w)"><g id="s">',
            *texts,
            "</g></g></svg>\n",
        ]
    )


def main() -> None:
    """Run the tutorial and draw it."""
    with tempfile.TemporaryDirectory() as folder:
        draw(list(run(TUTORIAL.read_text("utf-8"), Path(folder).resolve())))
    print(f"wrote {TARGET}")


def draw(ran: Sequence[Ran]) -> None:
    """Draw a run of the tutorial to TARGET."""
    TARGET.write_text(drawn(recorded(ran)), "utf-8")


if __name__ == "__main__":
    main()
