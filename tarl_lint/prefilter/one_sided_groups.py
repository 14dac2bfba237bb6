"""Find groups of modules that only subscribe or only publish, by words and syntax; most of them need not be run.

A flow needs both. The function `ruled_out` of a hazard rule returns whether such a group contains nothing that the
rule reports. If an enabled rule does not rule out a group, the group is run like any other.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from typing import Final, Protocol

from tarl_lint import catalog
from tarl_lint.evidence import Evidence
from tarl_lint.model import Finding
from tarl_lint.prefilter.by_words import code, whole
from tarl_lint.read.module_names import KNOWN
from tarl_lint.read.source import Module, occurs
from tarl_lint.settings.config import Config
from tarl_lint.trees import outside_functions

HEARS: Final = re.compile("|".join(map(whole, catalog.SOURCE_WORDS)))
# with the setting `tf2`, a file that looks up transforms also receives data
LOOKS_UP: Final = re.compile("|".join(map(whole, catalog.LOOKUP_WORDS)))
# matches the words of servers, which both receive and send
ANSWERS: Final = re.compile(r"Service\(|create_service|ActionServer")
# with the setting `clients`, a file that calls services or actions receives and sends data
CLIENTS: Final = re.compile("|".join(map(whole, catalog.CLIENT_WORDS)))
SAYS: Final = re.compile("|".join(map(whole, catalog.SINK_WORDS)))


@dataclass(frozen=True)
class Side:
    """A group of modules without a flow: they only subscribe (`hears`), only publish (`says`), or neither.

    `texts` are the modules' texts without comments.
    """

    modules: Sequence[Module]
    texts: Sequence[str]
    hears: bool
    says: bool


class Rule(Protocol):
    """The module of a hazard rule."""

    CODE: str
    SUMMARY: str
    INVALID: tuple[str, ...]
    VALID: tuple[str, ...]

    @staticmethod
    def findings(evidence: Evidence) -> Iterator[Finding]:
        """Yield the hazards in analysed modules."""

    @staticmethod
    def ruled_out(side: Side) -> bool:
        """Return whether words and syntax rule out all findings, so that the group need not be run."""


def one_sided(modules: Sequence[Module], config: Config, rules: Sequence[Rule]) -> bool:
    """Return whether a group of modules can contain no flow and no hazard of an enabled rule."""
    if config.named:
        return False
    texts = [code(m.text) for m in modules]
    hears, says = _hears_and_says(texts, config)
    if hears and says:
        return False
    if hears and any(
        _inherits_from_elsewhere(m.tree, {m.name.partition(".")[0] for m in modules}) for m in modules
    ):
        # a base class outside the files may receive the messages; the report then has a note that names the class
        return False
    side = Side(modules, texts, hears, says)
    return all(_ruled_out(rule, side) for rule in rules if config.enabled(rule.CODE))


def two_sided(texts: Sequence[str], config: Config) -> bool:
    """Return whether words alone show that modules with these texts are not one-sided."""
    return bool(config.named) or all(_hears_and_says([code(text) for text in texts], config))


def _hears_and_says(texts: Sequence[str], config: Config) -> tuple[bool, bool]:
    """Return two truth values: whether texts contain words used to subscribe, and words used to publish."""
    hears, says, answers = (_in_any(words, texts) for words in (HEARS, SAYS, ANSWERS))
    hears |= config.tf2 and _in_any(LOOKS_UP, texts)
    answers |= config.clients and _in_any(CLIENTS, texts)
    return (True, True) if answers else (hears, says)


def _in_any(words: re.Pattern[str], texts: Sequence[str]) -> bool:
    return any(occurs(words, text) for text in texts)


def _inherits_from_elsewhere(tree: ast.Module, ours: Set[str]) -> bool:
    """Return whether a class inherits from a class of an external package that is not part of Python or ROS."""
    known = KNOWN | ours
    names: set[str] = set()
    statements = [*outside_functions(tree.body)]
    for node in statements:
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            if (node.module or "").partition(".")[0] not in known:
                names.update(alias.asname or alias.name for alias in node.names)
        elif isinstance(node, ast.Import):
            roots = {alias.asname or alias.name.partition(".")[0]: alias.name for alias in node.names}
            names.update(name for name, module in roots.items() if module.partition(".")[0] not in known)
    bases = (base for node in statements if isinstance(node, ast.ClassDef) for base in node.bases)
    return bool(names) and any(_root(base) in names for base in bases)


def _root(expr: ast.expr) -> str:
    while isinstance(expr, ast.Attribute):
        expr = expr.value
    return expr.id if isinstance(expr, ast.Name) else ""


def _ruled_out(rule: Rule, side: Side) -> bool:
    """Return whether a rule excludes the group; a rule without `ruled_out` excludes none."""
    return hasattr(rule, "ruled_out") and rule.ruled_out(side)
