"""`tarl diff` for margins: show whether a robot became more fragile."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.stressing.margin_changes import Row
from pytest_tarl.stressing.margins import Margins

MARKS = {"more fragile": "❌ ", "more robust": "✅ ", "not comparable": "⚠️ "}


def guarantees_changed(before: Sequence[Margins], after: Sequence[Margins]) -> Iterator[str]:
    """Yield a note for each test whose guarantee changed."""
    old = {one.title: one for one in before}
    for one in after:
        was = old.get(one.title)
        if was is not None and (was.success, was.loss) != (one.success, one.loss):
            yield (
                f"{one.title}: the guarantee changed from a success rate of {100 * was.success:.4g} % and a loss of "
                f"{was.loss:.3g} to {100 * one.success:.4g} % and {one.loss:.3g}, because the test was recorded again."
            )


def lines(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the rows by test for a terminal."""
    title = ""
    for row in rows:
        if row.title != title:
            title = row.title
            yield title
        before, after = row.cells
        yield f"  {row.name:16} {before} → {after}: {row.change}"


def markdown(rows: Sequence[Row], since: str) -> Iterator[str]:
    """Yield the rows as a table for a pull request comment."""
    yield f"| test | direction | boundary {since} | boundary now | change |"
    yield "|---|---|---|---|---|"
    for row in rows:
        cells = (f"`{plain(row.title)}`", plain(row.name), *map(plain, row.cells))
        yield f"| {' | '.join(cells)} | {MARKS.get(row.change, '')}{row.change} |"


def table(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the current margins as a Markdown table."""
    yield "| test | direction | boundary |"
    yield "|---|---|---|"
    for row in rows:
        yield f"| `{plain(row.title)}` | {plain(row.name)} | {plain(row.cells[1])} |"


def plain(text: str) -> str:
    """Return a string that is safe inside a table cell."""
    return text.translate(_HARMLESS)


_HARMLESS = str.maketrans("|`\n<>", "¦' ‹›")
