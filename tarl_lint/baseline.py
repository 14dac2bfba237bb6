"""Accepted flows, `tarl-flows.json`: fingerprints without lines, load, subtract, write."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from tarl_lint.errors import BaselineError
from tarl_lint.files import write_whole
from tarl_lint.model import Finding, Flow, Kind

FORMAT_VERSION: Final = 1  # 1: first format
UNKNOWN: Final = "?"


@dataclass(frozen=True)
class Fingerprint:
    """What a flow is, apart from its place and its steps. Topics are texts, `?` when unknown."""

    package: str
    owner: str  # the class that subscribes, "" for none
    source: str
    callback: str
    sink: str
    place: str  # qualified name of what publishes
    kind: Kind

    def texts(self) -> tuple[str, ...]:
        """Return everything that tells flows apart, in the order that a baseline is sorted by."""
        return (self.package, self.owner, self.source, self.callback, self.sink, self.place, self.kind)

    def digest(self) -> str:
        """Return the fingerprint as 16 hexadecimal digits."""
        import hashlib  # OpenSSL, only where there are flows

        return hashlib.sha256("\0".join(self.texts()).encode("utf-8", "surrogatepass")).hexdigest()[:16]


@dataclass(frozen=True)
class Accepted:
    """A fingerprint, how many flows have it, and their files as seen from the baseline's directory."""

    fingerprint: Fingerprint
    count: int
    files: tuple[str, ...]


@dataclass(frozen=True)
class Baseline:
    """Everything that was accepted, sorted by fingerprint."""

    entries: tuple[Accepted, ...] = ()

    def counts(self) -> dict[str, int]:
        """Return digest → number of accepted flows."""
        return {entry.fingerprint.digest(): entry.count for entry in self.entries}


def fingerprint(flow: Flow, package: str) -> Fingerprint:
    """Return a flow's identity. `package` is the ROS package of its source, "" where there is none.

    Without one the Python package counts, and for a script its own name.
    """
    source, sink = flow.source, flow.sink
    return Fingerprint(
        package=package or source.module.rpartition(".")[0] or source.module,
        owner=source.qualname.rpartition(".")[0],
        source=topic_text(source.topics),
        callback=source.callback,
        sink=topic_text(sink.topics),
        place=sink.qualname,
        kind=flow.kind,
    )


def topic_text(topics: Sequence[str]) -> str:
    """Write the topics that one call may have: `odom`, `left or right`, `?` when unknown."""
    return " or ".join(topics) or UNKNOWN


def subtract(findings: Sequence[Finding], accepted: Mapping[str, int]) -> tuple[Finding, ...]:
    """Mark flows as accepted, unless their group is larger than what was accepted: then all of it is new."""
    found = Counter(f.fingerprint for f in findings if f.flow)
    return tuple(
        replace(f, status="accepted")
        if f.flow and found[f.fingerprint] <= accepted.get(f.fingerprint, 0)
        else f
        for f in findings
    )


def missing(
    baseline: Baseline, found: Mapping[str, int], judged: Callable[[Accepted], bool]
) -> tuple[tuple[Accepted, ...], tuple[Accepted, ...]]:
    """Return accepted flows that were not found, each with the number missing: (vanished, kept).

    `judged` tells whether this run can know of an entry. Not of one through a file that was not looked at or
    cannot be read: such entries are kept.
    """
    counts = ((entry, entry.count - found.get(entry.fingerprint.digest(), 0)) for entry in baseline.entries)
    lacking = [replace(entry, count=count) for entry, count in counts if count > 0]
    return tuple(e for e in lacking if judged(e)), tuple(e for e in lacking if not judged(e))


def merged(found: Iterable[Accepted], kept: Iterable[Accepted]) -> Baseline:
    """Return a baseline of what was found and what was kept unseen; equal fingerprints add up."""
    counts: Counter[Fingerprint] = Counter()
    files: dict[Fingerprint, set[str]] = {}
    for entry in (*found, *kept):
        counts[entry.fingerprint] += entry.count
        files.setdefault(entry.fingerprint, set()).update(entry.files)
    ordered = sorted(counts, key=Fingerprint.texts)
    return Baseline(tuple(Accepted(f, counts[f], tuple(sorted(files[f]))) for f in ordered))


def load(path: Path) -> Baseline:
    """Read a baseline. Raises BaselineError for a file that is damaged, foreign, or of a later format."""
    import json  # only where there is a baseline

    try:
        document = json.loads(path.read_bytes())
    except OSError as error:
        raise BaselineError(f"The baseline {path.as_posix()} cannot be read: {error.strerror}.") from None
    except ValueError as error:
        raise BaselineError(f"The baseline {path.as_posix()} is damaged ({error}): {_REMEDY}") from None
    if not isinstance(document, dict) or document.get("tool") != "tarl-lint":
        raise BaselineError(f"{path.as_posix()} is no baseline of tarl-lint: name another with --baseline.")
    version = document.get("format")
    if version != FORMAT_VERSION:
        raise BaselineError(
            f"The baseline {path.as_posix()} has format {version}, this tarl-lint reads {FORMAT_VERSION}: "
            "use the tarl-lint that wrote it, or delete it and run --write-baseline."
        )
    try:
        return merged((_entry(flow) for flow in document["flows"]), ())
    except (KeyError, TypeError, ValueError) as error:
        raise BaselineError(
            f"The baseline {path.as_posix()} is damaged ({_reason(error)}): {_REMEDY}"
        ) from None


_REMEDY: Final = "restore it from version control, or delete it and run --write-baseline."
_TEXTS: Final = {
    "source": "source",
    "callback": "callback",
    "sink": "sink",
    "in": "place",
    "class": "owner",
    "package": "package",
}


def _entry(flow: Any) -> Accepted:
    texts = {field: flow[key] for key, field in _TEXTS.items()}
    files, count, kind = flow["files"], flow["count"], flow["kind"]
    if not all(isinstance(text, str) for text in (*texts.values(), *files)):
        raise ValueError("a flow has something else where a text should be")
    if type(count) is not int or count < 1:
        raise ValueError(f"a flow has the count {count!r}")
    if kind not in ("explicit", "implicit"):
        raise ValueError(f"a flow has the kind {kind!r}")
    return Accepted(Fingerprint(kind=kind, **texts), count, tuple(files))


def _reason(error: Exception) -> str:
    return f"a flow lacks {error.args[0]!r}" if isinstance(error, KeyError) else str(error)


def dumps(baseline: Baseline) -> str:
    """Return the file's text: one flow a line, in words, so that a review shows what came and what went."""
    import json

    lines = ",\n".join(f"  {json.dumps(_words(entry), ensure_ascii=False)}" for entry in baseline.entries)
    flows = f"[\n{lines}\n ]" if lines else "[]"
    return f'{{"format": {FORMAT_VERSION}, "tool": "tarl-lint",\n "flows": {flows}}}\n'


def _words(entry: Accepted) -> dict[str, Any]:
    key = entry.fingerprint
    texts = {name: getattr(key, field) for name, field in _TEXTS.items()}
    return {"kind": key.kind, **texts, "count": entry.count, "files": list(entry.files)}


def save(path: Path, baseline: Baseline) -> None:
    """Write a baseline whole or not at all. Raises BaselineError when the place cannot be written."""
    try:
        write_whole(path, dumps(baseline))
    except OSError as error:
        place = path.as_posix()
        raise BaselineError(
            f"The baseline {place} cannot be written: {error.strerror}. Name another with --baseline."
        ) from None
