"""Draw one task from alarm to patch, from a real run: docs/images/repair.svg.

    python benchmarks/drift/picture.py [--task pipe_crawler] [--seed 0]

The picture has five panels and the patch. The panels show the rewards of episodes in both worlds; the cells in which
the worlds differ; the utility of the code lines in these cells (the slices) beside the effects found by simulation; the
candidates of the search; and the reward of the repair on fresh seeds.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ours import prepared
from stage import HERE, visit

from pytest_tarl.model import Comparison
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Order
from pytest_tarl.report.words import verdict_sentence

TARGET = HERE.parent.parent / "docs" / "images" / "repair.svg"
WIDTH, PANEL, HEIGHT, GAP, LINE = 960, 300, 190, 20, 15
INK, FAINT, GOOD, BAD = "#1d1d1f", "#9a9aa2", "#1b7f4b", "#b3261e"
STYLE = (
    f"text{{font:12px system-ui,sans-serif;fill:{INK}}} .t{{font-weight:600;font-size:13px}} "
    f".f{{fill:{FAINT}}} .m{{font:11.5px ui-monospace,monospace;white-space:pre}}"
)


@dataclass(frozen=True)
class Axis:
    """Maps a range of numbers to a range of pixels."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return where a number is drawn."""
        share = (value - self.low) / ((self.high - self.low) or 1.0)
        return self.start + share * (self.end - self.start)


def text(x: float, y: float, words: str, kind: str = "", more: str = "") -> str:
    """Write words."""
    return f'<text x="{x:.1f}" y="{y:.1f}" class="{kind}" {more}>{escape(words)}</text>'


def dots(values: Sequence[float], x: Axis, y: Axis, colour: str, start: int = 0) -> Iterator[str]:
    """Draw values in order."""
    for at, value in enumerate(values, start):
        yield f'<circle cx="{x(at):.1f}" cy="{y(value):.1f}" r="2.2" fill="{colour}" fill-opacity=".75"/>'


def level(value: float, x: Axis, y: Axis, colour: str, words: str) -> str:
    """Draw a labelled horizontal line."""
    line = (
        f'<line x1="{x.start:.1f}" x2="{x.end:.1f}" y1="{y(value):.1f}" y2="{y(value):.1f}" stroke="{colour}"'
    )
    below = 14 if y(value) < (y.start + y.end) / 2 else -6
    return f'{line} stroke-dasharray="3 3"/>' + text(x.end, y(value) + below, words, "f", 'text-anchor="end"')


def alarm(found: Comparison, x: Axis, y: Axis) -> Iterator[str]:
    """Show the rewards of both worlds."""
    for world, colour in (("offline", GOOD), ("online", BAD)):
        totals = found.totals[world][-40:]
        yield from dots(totals, Axis(0, len(totals), x.start, x.end), y, colour)
        yield level(sum(totals) / len(totals), x, y, colour, "designed" if world == "offline" else "drifted")


def where(found: Comparison, x: Axis, y: Axis) -> Iterator[str]:
    """Show the change of each cell, and the cells that were never visited before."""
    chosen = found.sensors[:2]
    cells = {**dict.fromkeys(found.region.novel, -1.0), **found.changes}
    columns, rows = ([*sorted({cell[d] for cell in cells})] for d in (0, 1))
    wide, high = (x.end - x.start) / len(columns), (y.start - y.end) / len(rows)
    most = max(found.changes.values(), default=1.0)
    for cell, change in cells.items():
        left, top = x.start + wide * columns.index(cell[0]), y.start - high * (rows.index(cell[1]) + 1)
        fill = (
            f'fill="{BAD}" fill-opacity="{0.08 + 0.9 * change / most:.2f}"'
            if change >= 0
            else 'fill="url(#new)"'
        )
        yield f'<rect x="{left:.1f}" y="{top:.1f}" width="{wide - 1:.1f}" height="{high - 1:.1f}" {fill}/>'
    ends = [f"{end:g}" for end in chosen[0].interval(columns[0], columns[-1])]
    yield text(
        x.start,
        y.start + 14,
        f"→ {chosen[0].name}, {ends[0]} to {ends[1]} {chosen[0].unit}; ↑ {chosen[1].name}",
        "f",
    )


def lines(found: Comparison, x: Axis, y: Axis) -> Iterator[str]:
    """Show the slices beside the results of simulation, by line."""
    slices: dict[str, float] = {}
    for cut in (cut for compared in found.lists for cut in compared.slices):
        slices[cut.site.id] = max(slices.get(cut.site.id, 0.0), abs(cut.difference))
    gains = {one.site.id: max((o.effect for o in one.operands), default=0.0) for one in found.culprits}
    shown = sorted(found.culprits, key=lambda one: one.site.line)
    step = (y.start - y.end) / len(shown)
    middle = (x.start + x.end) / 2
    for at, one in enumerate(shown):
        top = y.end + at * step
        for value, most, left, colour in (
            (slices.get(one.site.id, 0.0), max(slices.values()), x.start, FAINT),
            (gains[one.site.id], max(gains.values()) or 1.0, middle + 16, GOOD),
        ):
            size = max(0.0, value / most) * (middle - x.start - 20)
            yield f'<rect x="{left:.1f}" y="{top:.1f}" width="{size:.1f}" height="{step - 2:.1f}" fill="{colour}"/>'
        yield text(
            middle + 10, top + step - 2, str(one.site.line), "f", 'text-anchor="end" style="font-size:9px"'
        )
    yield text(x.start, y.start + 14, "slices: |Δ utility|", "f")
    yield text(middle + 16, y.start + 14, "asked: reward gained", "f")


def search(order: Order, found: Comparison, x: Axis, y: Axis) -> Iterator[str]:
    """Show the candidates of the search, episode by episode."""
    totals = found.searches[0].totals
    across = Axis(0, len(totals), x.start, x.end)
    yield level(order.goal.near, x, y, FAINT, "worth confirming")
    for at, total in enumerate(totals):
        yield from dots([total], across, y, GOOD if total >= order.goal.near else INK, at)
    yield text(x.start, y.start + 14, f"{len(totals)} episodes of the drifted world, in order", "f")


def holds(found: Comparison, x: Axis, y: Axis) -> Iterator[str]:
    """Show the repaired node on held-out seeds."""
    yield level(sum(found.totals["offline"]) / len(found.totals["offline"]), x, y, FAINT, "as designed")
    middle = (x.start + x.end) / 2
    for world, start, words in (("repaired", x.start, "drifted"), ("nominal_repaired", middle, "designed")):
        totals = found.totals[world][:40]
        yield from dots(totals, Axis(-1, len(totals), start, start + (x.end - x.start) / 2), y, GOOD)
        yield text(start, y.start + 14, f"{words} world, {len(totals)} seeds", "f")


def panel(at: int, title: str, marks: Iterator[str]) -> Iterator[str]:
    """Draw one of the panels."""
    left, top = _corner(at)
    yield text(left, top + 14, title, "t")
    yield f'<rect x="{left}" y="{top + 24}" width="{PANEL}" height="{HEIGHT - 50}" fill="none" stroke="#e3e3e8"/>'
    yield from marks


def _corner(at: int) -> tuple[int, int]:
    return GAP // 2 + (PANEL + GAP) * (at % 3), 10 + (HEIGHT + GAP) * (at // 3)


def _axes(at: int, values: Sequence[float]) -> tuple[Axis, Axis]:
    left, top = _corner(at)
    slack = 0.08 * (max(values) - min(values) or 1.0)
    across = Axis(0, 1, left + 8, left + PANEL - 8)
    return across, Axis(min(values) - slack, max(values) + slack, top + HEIGHT - 28, top + 28)


def drawn(order: Order, found: Comparison) -> str:
    """Return the picture."""
    assert found.repair is not None
    values = [total for totals in found.totals.values() for total in totals] + [*found.searches[0].totals]
    plain = [_axes(at, values) for at in range(5)]
    best = found.culprits[0]
    marks = [
        *panel(0, "1  Alarm: an episode earns less", alarm(found, *plain[0])),
        *panel(1, "2  Where they differ (hatched: never seen)", where(found, *plain[1])),
        *panel(2, "3  Which line: slices, and asking", lines(found, *plain[2])),
        *panel(3, "4  Search: one constant after the other", search(order, found, *plain[3])),
        *panel(4, "5  Does it hold? Fresh seeds", holds(found, *plain[4])),
    ]
    left, top = _corner(5)
    told = [verdict_sentence(found), f"First: line {best.site.line}, {best.site.code}", found.ranking]
    marks.append(text(left, top + 14, "In words", "t"))
    marks += [
        text(left, top + 36 + 15 * at, line)
        for at, line in enumerate(row for one in told for row in _wrapped(one))
    ]
    bottom = 2 * (HEIGHT + GAP) + 20
    marks.append(text(GAP // 2, bottom, "6  Patch", "t"))
    body = [line for line in found.repair.diff.splitlines() if not line.startswith(("#", "diff", "index"))]
    for at, line in enumerate(body):
        colour = {"+": GOOD, "-": BAD}.get(line[:1], INK)
        marks.append(text(GAP // 2, bottom + 20 + LINE * at, line, "m", f'style="fill:{colour}"'))
    height = bottom + 30 + LINE * len(body)
    hatching = (
        '<defs><pattern id="new" width="6" height="6" patternUnits="userSpaceOnUse">'
        f'<path d="M0 6 6 0" stroke="{BAD}" stroke-opacity=".5"/></pattern></defs>'
    )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}">',
            f'<style>{STYLE}</style>{hatching}<rect width="100%" height="100%" fill="#fff"/>',
            *marks,
            "</svg>\n",
        ]
    )


def _wrapped(words: str, width: int = 46) -> list[str]:
    rows = [""]
    for word in words.split():
        if len(rows[-1]) + len(word) > width:
            rows.append("")
        rows[-1] = f"{rows[-1]} {word}".strip()
    return rows


def main() -> None:
    """Run the task and draw it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--task", default="pipe_crawler")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--target", type=Path, default=TARGET)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent).resolve() / arguments.task
        shutil.copytree(HERE / arguments.task, folder, ignore=shutil.ignore_patterns("__pycache__"))

        def look(stage: object) -> str:
            order = prepared(stage, arguments.seed)  # type: ignore[arg-type]
            return drawn(order, repair(order).comparison)

        arguments.target.write_text(visit(arguments.task, look, folder))
    print(f"wrote {arguments.target}")


if __name__ == "__main__":
    main()
