"""Fingerprints: the identity of a finding in a baseline. A fingerprint does not depend on position and steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from tarl_lint.model import CODES, Finding, Flow, Kind, Sink, Source

UNKNOWN: Final = "?"


@dataclass(frozen=True)
class OfFlow:
    """A flow.

    Topics are strings, `?` if unknown. The package is the ROS package if there is one, else the Python package, else
    the script.
    """

    package: str
    owner: str  # the subscribing class; "" if there is none
    source: str
    callback: str
    sink: str
    place: str  # qualified name of the publishing function
    kind: Kind

    @property
    def code(self) -> str:
        """Return the code of the rule for the flow's kind."""
        return CODES[self.kind]

    def texts(self) -> tuple[str, ...]:
        """Return the strings that identify the flow: package, class, source, callback, sink, place, kind."""
        return (self.package, self.owner, self.source, self.callback, self.sink, self.place, self.kind)

    def digest(self) -> str:
        """Return the fingerprint as 16 hexadecimal digits."""
        return digest(self.texts())


@dataclass(frozen=True)
class OfHazard:
    """A hazard: its rule, its subject (topics, an attribute), and its function."""

    package: str
    rule: str
    about: str
    place: str

    @property
    def code(self) -> str:
        """Return the code of the hazard's rule."""
        return self.rule

    def texts(self) -> tuple[str, ...]:
        """Return the strings that identify the hazard: package, rule, subject, place."""
        return (self.package, self.rule, self.about, self.place)

    def digest(self) -> str:
        """Return the fingerprint as 16 hexadecimal digits."""
        return digest(self.texts())


Fingerprint = OfFlow | OfHazard


def digest(texts: Sequence[str]) -> str:
    """Return a digest of strings as 16 hexadecimal digits."""
    import hashlib  # slow to import because it loads OpenSSL, and needed only if there are findings

    return hashlib.sha256("\0".join(texts).encode("utf-8", "surrogatepass")).hexdigest()[:16]


def of_finding(finding: Finding, package: str, module: str) -> Fingerprint:
    """Return the fingerprint of a finding. `package` and `module` belong to the file where the finding begins."""
    if finding.flow is not None:
        return of_flow(finding.flow, package)
    return OfHazard(_package(package, module), finding.code, finding.about, finding.place)


def of_flow(flow: Flow, package: str) -> OfFlow:
    """Return the fingerprint of a flow. `package` is the ROS package of the flow's source; "" if there is none."""
    source, sink = flow.source, flow.sink
    return OfFlow(
        package=_package(package, source.module),
        owner=source.qualname.rpartition(".")[0],
        source=_in_baseline(source),
        callback=source.callback,
        sink=_in_baseline(sink),
        place=sink.qualname,
        kind=flow.kind,
    )


def _package(package: str, module: str) -> str:
    return package or module.rpartition(".")[0] or module


def _in_baseline(end: Source | Sink) -> str:
    """Return the topics of an end of a flow; a default name counts as unknown, because a launch file may replace it."""
    return UNKNOWN if end.default_topics else topic_text(end.topics)


def topic_text(topics: Sequence[str]) -> str:
    """Return the possible topics of one call: `odom`, `left or right`, `?` if unknown."""
    return " or ".join(topics) or UNKNOWN
