"""Documentation of a rule, from its own file: for `--explain` and for its page in docs/rules."""

from __future__ import annotations

import inspect
import pkgutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Final

from tarl_lint import rules
from tarl_lint.errors import UsageError
from tarl_lint.report.line import Line
from tarl_lint.settings.config import suggestion

# minimum similarity (0 to 1) of a suggested code. The value is high because all codes begin with TARL.
ALIKE: Final = 0.8
_HEADINGS: Final = (("INVALID", "Reported"), ("VALID", "Not reported"))


def known_rules() -> Mapping[str, ModuleType]:
    """Return code → module of the rule, sorted by code. Every module in `rules` with a `CODE` is a rule."""
    files = (import_module(f"{rules.__name__}.{m.name}") for m in pkgutil.iter_modules(rules.__path__))
    return dict(sorted((file.CODE, file) for file in files if hasattr(file, "CODE")))


def check_codes(codes: Sequence[str], where: str) -> None:
    """Raise UsageError for a code or prefix that no rule has."""
    known = list(known_rules())
    for code in codes:
        if not any(k.startswith(code) for k in known):
            meant = suggestion(code, known, ALIKE)
            raise UsageError(
                f"{where} names {code!r}, which is not a rule{meant} Rules are {', '.join(known)}."
            )


def explanation(code: str) -> Iterator[Line]:
    """Yield the documentation of a rule for the terminal. Raises UsageError for an unknown code."""
    inside, before = False, ""
    for line in page(code.upper()).splitlines():
        if line.startswith("```"):
            inside = not inside
            if inside and before == "```":
                yield (("    " + "-" * 8, "quiet"),)  # separates two examples
                yield ()
            before = line
        elif inside:
            yield ((f"    {line}".rstrip(), ""),)
        else:
            before = line or before
            yield ((line.lstrip("# "), "strong" if line.startswith("#") else ""),)


def page(code: str) -> str:
    """Return a rule's page in Markdown. Raises UsageError for an unknown code."""
    known = known_rules()
    several = [k for k in known if k.startswith(code)] if code else []
    if code not in known and several:
        raise UsageError(f"{code} stands for {', '.join(several)}: name one of them.")
    if code not in known:
        raise UsageError(
            f"There is no rule {code!r}{suggestion(code, list(known), ALIKE)} Rules are {', '.join(known)}."
        )
    rule = known[code]
    title, _, text = (inspect.getdoc(rule) or "").partition("\n")
    return f"# {title.rstrip('.')}\n\n{text.strip()}\n{_examples(rule)}"


def _examples(rule: ModuleType) -> str:
    """Return the rule's snippets, which are its tests, as code blocks below headings."""
    return "".join(
        f"\n## {heading}\n"
        + "".join(_block(snippet, "text" if "--- " in snippet else "python") for snippet in snippets)
        for name, heading in _HEADINGS
        if (snippets := getattr(rule, name, ()))
    )


def _block(snippet: str, language: str) -> str:
    return f"\n```{language}\n{inspect.cleandoc(snippet)}\n```\n"


def write_pages(directory: Path) -> None:
    """Write the page of every rule into a directory of the documentation."""
    for code in known_rules():
        (directory / f"{code}.md").write_text(page(code), encoding="utf-8")


if __name__ == "__main__":
    write_pages(Path(sys.argv[1]))
