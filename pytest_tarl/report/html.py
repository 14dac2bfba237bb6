"""Write the report page: one self-contained HTML file."""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from pytest_tarl.errors import TarlError
from pytest_tarl.extras import install_command
from pytest_tarl.files import advice_on
from pytest_tarl.model import Comparison, ListComparison
from pytest_tarl.report import (
    amounts,
    drift_sizes,
    formulas,
    guarantee_words,
    next_commands,
    repair_words,
    words,
)
from pytest_tarl.report.figures import MOST_ROWS, plane, reward_curves, utility_figure
from pytest_tarl.report.slices import chart
from tarl_lint.files import write_atomically

NEEDED = ("jinja2", "plotly", "pygments")
_RANGE = re.compile(r"(?<=\d)-(?=\d)")
_MINUS = re.compile(r"(?<![\w.])-(?=\d)")
_IN_SCRIPT = {ord(character): f"\\u{ord(character):04x}" for character in "<>&\u2028\u2029"}


def write(comparison: Comparison, path: Path, *, title: str | None = None) -> None:
    """Write the page; `title` replaces the test's name.

    Raises:
        TarlError: a package of the extra `report` is missing, or the file cannot be written.
    """
    text = render(comparison, title=title)
    try:
        write_atomically(path, text.encode(), parents=True)
    except OSError as error:
        raise TarlError(
            f"The report {path} cannot be written ({error.strerror or error}): {advice_on(error)}"
        ) from error


def render(comparison: Comparison, *, title: str | None = None) -> str:
    """Return the page as HTML. Raise TarlError if the extra `report` is not installed."""
    templates = environment(asset, NEEDED)
    from pytest_tarl.report import highlight

    templates.filters |= {
        "amount": lambda value: typeset(amounts.amount(value)),
        "signed": lambda value: typeset(amounts.signed(value)),
        "capitalize_first": lambda text: text[:1].upper() + text[1:],
        "plain": lambda value: typeset(f"{value:.6g}"),
        "p": amounts.p_value,
        "margin": lambda value: typeset(formulas.margin(value)),
        "code": lambda text: highlight.code_html(words.one_line(text)),
        "patch": highlight.patch_lines,
    }
    drawn = _data(comparison)
    text: str = templates.get_template("page.html").render(
        **_context(comparison, title, drawn),
        css=asset("page.css"),
        script=asset("page.js"),
        library=_library(),
        data=in_script(drawn),
    )
    return text


def environment(source: Callable[[str], str], needed: Sequence[str]) -> Any:
    """Return the jinja2 environment of a page; `source` returns a template's text by name.

    Raise TarlError if a package that the page needs is missing.
    """
    _require(needed)
    return _templates(source)


@cache
def _templates(source: Callable[[str], str]) -> Any:
    # there is one environment per page, because compiling its templates takes about 0.2 s
    import jinja2

    found = jinja2.Environment(
        loader=jinja2.FunctionLoader(source), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    found.filters |= {"typeset": typeset, "parts": parts}
    return found


def _require(needed: Sequence[str]) -> None:
    missing = [package for package in needed if find_spec(package) is None]
    if missing:
        raise TarlError(
            f"The report page needs {' and '.join(missing)}, which is not installed: run "
            f"{install_command('report')}. Verdict and patch do not depend on it."
        )


def asset(name: str) -> str:
    """Return a file that the page includes, as text."""
    return resources.files(__package__).joinpath("page").joinpath(name).read_text("utf-8")


@lru_cache(maxsize=1)
def _library() -> str:
    """Return plotly.js as base64, compressed to about 40 %; the browser decompresses it."""
    script = resources.files("plotly").joinpath("package_data").joinpath("plotly.min.js").read_bytes()
    return base64.b64encode(zlib.compress(script, 9)).decode("ascii")


def in_script(data: Any) -> str:
    """Return data as JSON that is safe inside a script element."""
    return json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":")).translate(_IN_SCRIPT)


def parts(text: str) -> list[str]:
    """Split a path or test id where lines may be wrapped."""
    return re.findall(r".+?(?:::|[/_.]|$)", text)


def typeset(text: str) -> str:
    """Typeset ranges with a dash and negative numbers with a minus sign."""
    return _MINUS.sub("−", _RANGE.sub("–", text))


def _data(comparison: Comparison) -> dict[str, Any]:
    """Return the data for the page's script."""
    return {
        "world": comparison.drift or "deployed",
        "utility": [utility_figure(comparison, compared) for compared in comparison.lists],
        "curves": reward_curves(comparison),
        "offline": amounts.atr(comparison, "offline"),
        "tolerance": comparison.verdict.tolerance,
    }


def _context(comparison: Comparison, title: str | None, drawn: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the variables of the page template."""
    name = title or comparison.test
    return {
        "c": comparison,
        "title": name,
        "world": comparison.drift or "deployed",
        "headline": words.verdict_sentence(comparison),
        "loss": words.loss_words(comparison),
        "stated": [
            (name, list(guarantee_words.sentences(one))) for name, one in guarantee_words.worlds(comparison)
        ],
        "region": words.region_words(comparison),
        "paper_region": words.paper_region_words(comparison),
        "atr": {
            world: amounts.atr(comparison, world) for world, totals in comparison.totals.items() if totals
        },
        "share": _share(comparison),
        "lists": [
            _list(comparison, compared, figure)
            for compared, figure in zip(comparison.lists, drawn["utility"], strict=True)
        ],
        "sizes": drift_sizes.plots(comparison),
        "curves": _curves_in_words(drawn["curves"]),
        "clipped": _clipped(drawn["curves"]),
        "repair_words": repair_words.repair_words(comparison.repair) if comparison.repair else "",
        "best_words": repair_words.best_words(comparison.repair) if comparison.repair else "",
        "history": [repair_words.attempt_words(one) for one in comparison.repair.history]
        if comparison.repair
        else [],
        "refusal": repair_words.refusal(comparison.repair) if comparison.repair else "",
        "partial": repair_words.partial_words(comparison.repair.partial, comparison)
        if comparison.repair and comparison.repair.partial
        else "",
        "ways_out": repair_words.ways_out(comparison),
        "wider_tolerance": repair_words.wider_tolerance(comparison),
        "designed_world": words.designed_world(comparison),
        "command": next_commands.repeat(comparison),
        "next_steps": list(next_commands.next_steps(comparison)),
        "lost": lambda part: words.lost_words(comparison, part),
        "formulas": formulas.page_rows(comparison),
        "place": lambda site: f"{site.path}:{site.line}",
    }


def _clipped(curves: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether the figure clips the curve of the designed world."""
    offline = [len(curve["mean"]) for curve in curves if curve["kind"] == "offline"]
    others = [len(curve["mean"]) for curve in curves if curve["kind"] != "offline"]
    return bool(offline and others) and max(offline) > max(others)


def _share(comparison: Comparison) -> float | None:
    """Return the percentage of the lost reward that the repair restored."""
    worlds = [amounts.atr(comparison, world) for world in ("offline", "online", "repaired")]
    offline, online, repaired = worlds
    if offline is None or online is None or repaired is None or offline <= online:
        return None
    return 100 * (repaired - online) / (offline - online)


def _list(
    comparison: Comparison, compared: ListComparison, figure: Mapping[str, Any] | None
) -> dict[str, Any]:
    return {
        "name": compared.taint_list.name,
        "figure": figure,
        "chart": chart(compared.slices),
        "captions": list(_captions(comparison, figure)) if figure else [],
        "summary": _largest_change(figure) if figure else "",
        "paths": sorted({site.path for site in compared.taint_list.sites}),
    }


def _captions(comparison: Comparison, figure: Mapping[str, Any]) -> Iterator[str]:
    """Yield notes on what the utility figure shows and omits."""
    shown = plane(comparison)
    if others := shown.others(comparison.sensors):
        yield f"Each value is the mean over {' and '.join(others)}."
    if shown.split is not None and len({cell[shown.split] for cell in comparison.cells}) > MOST_ROWS:
        yield f"Only the {MOST_ROWS} most frequent values of {comparison.sensors[shown.split].name} are shown."
    if figure["axis"]["outside"]:
        yield "The outermost columns hold all values beyond the range."


def _largest_change(figure: Mapping[str, Any]) -> str:
    """Describe the largest difference between the two worlds' utilities."""
    found = [
        (on - off, row["title"], site, figure["axis"]["names"][column])
        for row in figure["rows"]
        for site, before, after in zip(figure["sites"], row["offline"], row["online"], strict=True)
        for column, (off, on) in enumerate(zip(before, after, strict=True))
        if off is not None and on is not None
    ]
    if not found:
        return "No cell was visited in both worlds."
    change, title, (line, code, _), name = max(found, key=lambda one: abs(one[0]))
    where = typeset(f"{name}, {title}" if title else name)
    amount = typeset(amounts.signed(change))
    return f"The largest change, {amount}, is at {where}, in line {line} (“{words.one_line(code)}”)."


def _curves_in_words(curves: Iterable[Mapping[str, Any]]) -> str:
    """Describe the last value of each reward curve (alternative text)."""
    ends = []
    for curve in curves:
        end = typeset(amounts.amount(curve["mean"][-1]))
        ends.append(f"{curve['name']} {end} after {len(curve['mean'])} episodes")
    return "; ".join(ends)
