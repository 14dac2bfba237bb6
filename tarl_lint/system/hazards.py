"""Places and identities of a system's hazards, which the rules TARL3xx find."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from typing import Final, Protocol, cast

from tarl_lint.files import shown
from tarl_lint.fingerprints import OfHazard
from tarl_lint.model import RULES, Finding, Span
from tarl_lint.settings.config import Config
from tarl_lint.system.model import Endpoint, Instance, System


class Rule(Protocol):
    """A rule about systems: a file `rules/tarl3xx.py`."""

    CODE: str

    def findings(self, system: System) -> Iterator[Finding]:
        """Yield the hazards of a system."""


ARCHITECTURE: Final = tuple(code for code in RULES if code.startswith("TARL3"))


# rules about single programs; other rules assume nodes that run together
_OF_PROGRAMS: Final = ("TARL306", "TARL309")


def hazards(system: System, config: Config) -> tuple[Finding, ...]:
    """Return the hazards of the enabled rules, with fingerprints, sorted by place.

    Without a launch file, the system contains all nodes of a folder, even if they belong to different robots.
    """
    found: set[Finding] = set()
    for code in _OF_PROGRAMS if system.file.is_dir() else ARCHITECTURE:
        if config.enabled(code):
            rule = cast("Rule", import_module(f"tarl_lint.rules.{code.lower()}"))
            found |= {_identified(one) for one in rule.findings(system)}
    return tuple(sorted(found, key=lambda one: (one.span, one.code, one.message)))


def _identified(finding: Finding) -> Finding:
    fingerprint = OfHazard(finding.package, finding.code, finding.about, finding.place)
    return replace(finding, fingerprint=fingerprint.digest())


def at_node(code: str, instance: Instance, message: str, about: str) -> Finding:
    """Return a hazard at the place where a launch file starts a node; `about` contains names from the code."""
    node = instance.node
    span = Span(shown(node.file), max(node.line, 1), 1, max(node.line, 1), 2)
    return Finding(
        code, span, message, about=about, place=f"{node.package}/{node.executable}", package=node.package
    )


def at_end(code: str, instance: Instance, endpoint: Endpoint, message: str, about: str) -> Finding:
    """Return a hazard at the code of an endpoint."""
    package = instance.interface.package if instance.interface is not None else instance.node.package
    return Finding(code, endpoint.span, message, about=about, place=endpoint.place, package=package)


def single(endpoint: Endpoint) -> str:
    """Return the type of an endpoint; "" if the type is unknown, or may be one of several."""
    return "" if " | " in endpoint.type or endpoint.type == "AnyMsg" else endpoint.type


def differ(one: Endpoint, other: Endpoint) -> bool:
    """Return whether two endpoints certainly have different types; packages are compared if both are known."""
    if not single(one) or not single(other):
        return False
    whole = one.whole_type and other.whole_type
    return one.whole_type != other.whole_type if whole else one.type != other.type
