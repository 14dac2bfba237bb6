"""Report a comparison on the terminal, in a few labelled lines."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap

from pytest_tarl.model import Comparison, Culprit, ListComparison, Slice
from pytest_tarl.report import (
    amounts,
    drift_sizes,
    formulas,
    guarantee_words,
    next_commands,
    repair_words,
    slices,
    words,
)

SHOWN = 3  # maximum number of culprits, lists and notes to show before "(and 3 more)"
LABEL = 9  # width of the label column
# columns; code is printed on the same line as its location if this much is free, otherwise on the next line
LEGIBLE = 24
NARROWEST = 40  # minimum width of the report in columns


def lines(comparison: Comparison, *, width: int, root: Path, page: Path | None = None) -> list[str]:
    """Return the report of a comparison, `width` columns wide; `page` is the path of the report page, if any.

    Paths and commands are never wrapped, so that they can be copied; they may be wider than the report.
    """
    width = max(width, NARROWEST)
    name = f"{comparison.test}[{comparison.drift or 'online'}]"
    told = [f"{name}: {comparison.verdict.result}"]
    for label, texts in _entries(comparison, width, root, page):
        for at, text in enumerate(texts):
            told += _labelled("" if at else label, text, width, whole=label in ("page", "again", "next"))
    return told


def _entries(
    comparison: Comparison, width: int, root: Path, page: Path | None
) -> Iterator[tuple[str, list[str]]]:
    yield "verdict", [words.verdict_sentence(comparison)]
    yield "reward", [_rewards(comparison)]
    yield (
        "bounds",
        [
            f"{world}: {told}"
            for world, one in guarantee_words.worlds(comparison)
            for told in guarantee_words.brief(one)
        ],
    )
    yield "loss", list(_loss(comparison))
    yield "sizes", list(drift_sizes.lines(comparison))
    yield "formula", list(formulas.lines(comparison))
    if comparison.verdict.result != "no difference":
        yield "parts", list(_parts(comparison))
        yield "where", [words.region_words(comparison) or "no single situation stands out"]
        yield "lines", list(_culprits(comparison, width - LABEL - 2, root))
        yield "ranking", [comparison.ranking] if comparison.ranking else []
        yield "slices", list(_slices(comparison, root))
    yield "repair", list(_repair(comparison))
    yield "note", list(_some([words.one_line(note) for note in comparison.notes]))
    yield "page", [_shown(page, root)] if page else []
    yield "again", [next_commands.repeat(comparison)]
    yield "next", list(next_commands.next_steps(comparison))


def _labelled(label: str, text: str, width: int, *, whole: bool) -> list[str]:
    """Put a label before text; `whole` text is not wrapped."""
    body = [text] if whole else [line for part in text.split("\n") for line in _wrapped(part, width)]
    return [f"  {label if i == 0 else '':<{LABEL}}{line}".rstrip() for i, line in enumerate(body)]


def _wrapped(text: str, width: int) -> list[str]:
    """Wrap `text` between words, but keep numbers and their percent signs together."""
    joined = text.replace(" %", "\0%")
    told = wrap(joined, width - LABEL - 2, break_on_hyphens=False, break_long_words=False)
    return [line.replace("\0", " ") for line in told] or [""]


def _rewards(comparison: Comparison) -> str:
    named = {
        "offline": "designed",
        "online": "deployed",
        "repaired": "repaired",
        "nominal_repaired": f"{words.designed_world(comparison)} repaired",
    }
    figures = [
        f"{name} {amounts.amount(amounts.atr(comparison, world))}"
        for world, name in named.items()
        if comparison.totals.get(world)
    ]
    return ", ".join(figures)


def _loss(comparison: Comparison) -> Iterator[str]:
    sure = words.loss_words(comparison)
    if sure and comparison.verdict.result != "no difference":
        yield f"{amounts.amount(comparison.verdict.loss)} per episode, {sure}"


def _parts(comparison: Comparison) -> Iterator[str]:
    lines = []
    for name, by in words.lost_parts(comparison):
        where = words.lost_words(comparison, name)
        lines.append(f"{name} {amounts.signed(by)}{' where ' if where else ''}{where}")
    return _some(lines)


def _culprits(comparison: Comparison, width: int, root: Path) -> Iterator[str]:
    ranked = enumerate(comparison.culprits, start=1)
    return _some([_culprit(f"{rank}.", culprit, width, root) for rank, culprit in ranked])


def _culprit(rank: str, culprit: Culprit, width: int, root: Path) -> str:
    site = culprit.site
    evidence = "by its slice" if culprit.method == "slices" else "no operand helps"
    if culprit.operands:
        best = culprit.operands[0]
        evidence = f"{repair_words.operand_words(best)}: {amounts.signed(best.effect)}"
    where = f"{rank} {words.place(site.path, site.line, root)}"
    room = width - len(where) - len(evidence) - 6
    if room < LEGIBLE and room < len(words.one_line(site.code)):
        return f"{where}  ({evidence})\n{' ' * len(rank)} {words.one_line(site.code, width - len(rank) - 1)}"
    return f"{where}  {words.one_line(site.code, room)}  ({evidence})"


def _slices(comparison: Comparison, root: Path) -> Iterator[str]:
    peaks = ((one, slices.peak(one.slices)) for one in comparison.lists)
    return _some([_slice_summary(one, peak, root) for one, peak in peaks if peak])


def _slice_summary(compared: ListComparison, peak: Slice, root: Path) -> str:
    change = f"{amounts.amount(peak.offline)} to {amounts.amount(peak.online)}"
    where = words.place(peak.site.path, peak.site.line, root)
    return f"{compared.taint_list.name}: utility changes most at {where}, {change}"


def _repair(comparison: Comparison) -> Iterator[str]:
    repair = comparison.repair
    if repair is None:
        return
    if repair.accepted:
        yield f"accepted: {repair_words.repair_words(repair)}"
    else:
        yield f"none accepted: {repair_words.refusal(repair)}"
        if repair.edits:
            yield f"best so far: {repair_words.best_words(repair)}"
    if repair.partial is not None:
        part = repair.partial
        yield f"partial: {part.what}: {repair_words.partial_words(part, comparison)}; tarl apply --partial {part.patch}"
    yield from filter(None, (repair_words.ways_out(comparison), repair_words.wider_tolerance(comparison)))
    dropped = [one for one in repair.history if one.reason]
    if dropped and repair.accepted:
        yield f"{len(dropped)} tried before; the last: {repair_words.attempt_words(dropped[-1])}"
    elif dropped:
        yield from _some([f"tried {repair_words.attempt_words(one)}" for one in dropped[::-1]])


def _some(texts: list[str]) -> Iterator[str]:
    yield from texts[:SHOWN]
    if len(texts) > SHOWN:
        yield f"(and {len(texts) - SHOWN} more)"


def _shown(path: Path, root: Path) -> str:
    return (path.relative_to(root) if path.is_relative_to(root) else path).as_posix()
