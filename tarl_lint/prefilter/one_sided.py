"""Groups of modules that only hear or only say something, told by words and syntax: most need not be run.

A flow needs both. Each rule about hazards says itself when one side alone holds nothing for it (`ruled_out`); a group
that a wanted rule does not rule out is run like any other.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from typing import Final, Protocol

from tarl_lint import catalog
from tarl_lint.config import Config
from tarl_lint.evidence import Evidence
from tarl_lint.model import Finding
from tarl_lint.names import KNOWN
from tarl_lint.prefilter.by_words import code, whole
from tarl_lint.source import Module

HEARS: Final = re.compile("|".join(whole(w) for w in (*catalog.SOURCE_WORDS, *sorted(catalog.LOOKUPS))))
ANSWERS: Final = re.compile(r"Service\(|create_service|ActionServer")  # sources that are sinks, too
SAYS: Final = re.compile("|".join(map(whole, catalog.SINK_WORDS)))


@dataclass(frozen=True)
class Side:
    """Modules that belong together and hold no flow: they only hear or only say something, or neither.

    `texts` are those of the modules without comments.
    """

    modules: Sequence[Module]
    texts: Sequence[str]
    hears: bool
    says: bool


class Rule(Protocol):
    """A file about one hazard."""

    CODE: str
    SUMMARY: str
    INVALID: tuple[str, ...]
    VALID: tuple[str, ...]

    @staticmethod
    def findings(evidence: Evidence) -> Iterator[Finding]:
        """Yield the hazards in modules that were run."""

    @staticmethod
    def ruled_out(side: Side) -> bool:
        """Tell whether words and syntax rule out that there is anything to find, so that nothing need be run."""


def one_sided(modules: Sequence[Module], config: Config, rules: Sequence[Rule]) -> bool:
    """Tell whether nothing can be found in modules that belong together: no flow, and no hazard of the wanted rules."""
    if config.named:
        return False
    texts = [code(m.text) for m in modules]
    hears, says, answers = (any(map(words.search, texts)) for words in (HEARS, SAYS, ANSWERS))
    if answers or (hears and says):
        return False
    if hears and any(
        _inherits_from_elsewhere(m.tree, {m.name.partition(".")[0] for m in modules}) for m in modules
    ):
        return False  # what is heard may go into a base class that is not here, which a note names
    side = Side(modules, texts, hears, says)
    return all(_ruled_out(rule, side) for rule in rules if config.enabled(rule.CODE))


def _inherits_from_elsewhere(tree: ast.Module, ours: Set[str]) -> bool:
    """Tell whether a class inherits from one of a package that is neither here, nor Python's or ROS's own."""
    known = KNOWN | ours
    names: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            if (node.module or "").partition(".")[0] not in known:
                names.update(alias.asname or alias.name for alias in node.names)
        elif isinstance(node, ast.Import):
            roots = {alias.asname or alias.name.partition(".")[0]: alias.name for alias in node.names}
            names.update(name for name, module in roots.items() if module.partition(".")[0] not in known)
    bases = (base for node in tree.body if isinstance(node, ast.ClassDef) for base in node.bases)
    return bool(names) and any(_root(base) in names for base in bases)


def _root(expr: ast.expr) -> str:
    while isinstance(expr, ast.Attribute):
        expr = expr.value
    return expr.id if isinstance(expr, ast.Name) else ""


def _ruled_out(rule: Rule, side: Side) -> bool:
    """Ask a rule; one that does not say is asked about every group."""
    return hasattr(rule, "ruled_out") and rule.ruled_out(side)
