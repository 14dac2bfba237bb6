"""Show several drifts of a test as a table on the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from pytest_tarl.model import Comparison
from pytest_tarl.report import amounts, words

Row = tuple[str, ...]  # test, drift, designed reward, deployed reward, loss, verdict, region
HEAD = ("", "designed", "deployed", "loss", "verdict", "where")
NUMBERS = (1, 2, 3)  # indices of right-aligned columns


def row(comparison: Comparison) -> Row:
    """Return the table row of one comparison."""
    verdict = comparison.verdict
    return (
        comparison.test,
        comparison.drift or "online",
        amounts.amount(amounts.atr(comparison, "offline")),
        amounts.amount(amounts.atr(comparison, "online")),
        amounts.amount(verdict.loss),
        verdict.result,
        words.region_words(comparison) if verdict.result != "no difference" else "",
    )


def side_by_side(rows: Sequence[Row], width: int) -> list[str]:
    """Return one table, `width` columns wide, for each test with several drifts."""
    told: list[str] = []
    for test in dict.fromkeys(one[0] for one in rows):
        lines = [one[1:] for one in rows if one[0] == test]
        if len(lines) > 1:
            told += [*([""] if told else []), f"{test}, side by side", *_table([HEAD, *lines], width)]
    return told


def _table(lines: Sequence[Row], width: int) -> list[str]:
    widths = [max(len(line[i]) for line in lines) for i in range(len(HEAD))]
    told = []
    for line in lines:
        cells = [
            text.rjust(size) if i in NUMBERS else text.ljust(size)
            for i, (text, size) in enumerate(zip(line, widths, strict=True))
        ]
        text = "  " + "  ".join(cells).rstrip()
        told.append(text if len(text) <= width else text[: width - 1].rstrip() + "…")
    return told
