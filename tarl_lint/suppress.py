"""Comments that silence a finding: `# tarl: ignore`, `# tarl: ignore[TARL101]`, `# noqa: TARL101`.

In launch files of XML, the comment is `<!-- tarl: ignore[TARL308] -->`.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tarl_lint.model import RULES, Finding

_COMMENT: Final = (  # a string that is compiled at first use, since most runs never need the pattern
    r"(?i:#\s*(?:tarl:\s*ignore\b\s*(?:\[(?P<own>[^\]]*)\]?)?"
    r"|noqa:\s*(?P<noqa>[A-Z]+[0-9]+(?:[\s,]+[A-Z]+[0-9]+)*)))"
)
# endings of launch files that are not Python
XML: Final = (".launch", ".xml", ".test")
YAML: Final = (".yaml", ".yml")


@dataclass(frozen=True)
class Suppression:
    """One comment that silences rules. Lines and columns count from 1.

    `code` is a rule, a prefix of rules (`TARL1`), or "" for all rules.
    """

    path: str
    line: int
    column: int
    code: str = ""

    def covers(self, finding: Finding) -> bool:
        """Return whether the comment is on a line of the finding and names its rule."""
        span = finding.span
        on_it = self.path == span.path and span.line <= self.line <= span.end_line
        return on_it and self.code in ("", *_beginnings(finding.code))

    @property
    def rules(self) -> tuple[str, ...]:
        """Return the rules that the comment silences; empty if the code is unknown."""
        return tuple(rule for rule in RULES if self.code in ("", *_beginnings(rule)))


def _beginnings(rule: str) -> tuple[str, ...]:
    """Return the prefixes of a rule: `TARL`, `TARL1`, `TARL10` and `TARL101`."""
    return tuple(rule[:end] for end in range(4, len(rule) + 1))


def suppressions(path: str, text: str) -> tuple[Suppression, ...]:
    """Return the suppressions in a file. A plain `# noqa` belongs to other tools and is ignored."""
    if "tarl" not in text.lower():
        return ()
    return tuple(
        Suppression(path, line, column + found.start(), code)
        for line, column, comment in _in_file(path, text)
        for found in re.finditer(_COMMENT, comment)
        for code in _codes(found)
    )


def _codes(comment: re.Match[str]) -> tuple[str, ...]:
    """Return the rules that a comment names; "" means all rules. In a `noqa`, codes of other tools are ignored."""
    if comment["noqa"] is not None:
        words = re.split(r"[\s,]+", comment["noqa"].upper())
        return tuple(word for word in words if word.startswith("TARL"))
    if comment["own"] is None:
        return ("",)
    return tuple(word.strip().upper() for word in comment["own"].split(",") if word.strip())


def _in_file(path: str, text: str) -> Iterator[tuple[int, int, str]]:
    """Yield (line, column, text) of each comment of a Python, XML or YAML file; the text begins with `#`."""
    if path.endswith(XML):
        for found in re.finditer(r"<!--(.*?)-->", text, re.DOTALL):
            start = found.start()
            yield text.count("\n", 0, start) + 1, start - text.rfind("\n", 0, start), f"#{found[1]}"
    elif path.endswith(YAML):
        for number, line in enumerate(text.split("\n"), 1):
            if comment := re.search(r"(?:^|(?<=\s))#.*", line):
                yield number, comment.start() + 1, comment[0]
    else:
        yield from _comments(text)


def _comments(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield (line, column, text) of each comment, up to the place where the text cannot be tokenised."""
    import tokenize

    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.start[1] + 1, token.string
    except (tokenize.TokenError, SyntaxError):
        return


def apply(
    findings: Sequence[Finding], texts: Mapping[str, str]
) -> tuple[tuple[Finding, ...], tuple[Finding, ...], tuple[Suppression, ...]]:
    """Return the findings that are not silenced, the silenced findings, and the comments that silence nothing."""
    every = {path: suppressions(path, text) for path, text in texts.items()}
    kept: list[Finding] = []
    silenced: list[Finding] = []
    used: set[Suppression] = set()
    for finding in findings:
        matching = [s for s in every.get(finding.span.path, ()) if s.covers(finding)]
        used.update(matching)
        (silenced if matching else kept).append(finding)
    unused = tuple(s for found in every.values() for s in found if s not in used)
    return tuple(kept), tuple(silenced), unused
