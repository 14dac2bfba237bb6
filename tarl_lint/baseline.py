"""Accepted flows and hazards, `tarl-flows.json`: load, subtract, write."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from tarl_lint.errors import BaselineError
from tarl_lint.files import shown, write_atomically
from tarl_lint.fingerprints import Fingerprint, OfFlow, OfHazard
from tarl_lint.model import Finding

FORMAT_VERSION: Final = 1  # 1: first format


@dataclass(frozen=True)
class Accepted:
    """A fingerprint, the number of findings with it, and their files relative to the baseline's directory."""

    fingerprint: Fingerprint
    count: int
    files: tuple[str, ...]


@dataclass(frozen=True)
class Baseline:
    """All accepted findings, sorted by fingerprint."""

    entries: tuple[Accepted, ...] = ()

    def counts(self) -> dict[str, int]:
        """Return digest → number of accepted findings."""
        return {entry.fingerprint.digest(): entry.count for entry in self.entries}


def subtract(findings: Sequence[Finding], accepted: Mapping[str, int]) -> tuple[Finding, ...]:
    """Return the findings, marked as accepted where the baseline has them.

    If the run finds more findings with one fingerprint than the baseline accepts, all of them count as new.
    """
    found = Counter(f.fingerprint for f in findings)
    return tuple(
        replace(f, status="accepted") if found[f.fingerprint] <= accepted.get(f.fingerprint, 0) else f
        for f in findings
    )


def missing(
    baseline: Baseline, found: Mapping[str, int], judged: Callable[[Accepted], bool]
) -> tuple[tuple[Accepted, ...], tuple[Accepted, ...]]:
    """Return the accepted findings that were not found, as (vanished, kept), each with the number of missing findings.

    `judged` returns whether this run analysed everything that an entry needs. An entry is kept if one of its files was
    not analysed or is unreadable.
    """
    counts = ((entry, entry.count - found.get(entry.fingerprint.digest(), 0)) for entry in baseline.entries)
    lacking = [replace(entry, count=count) for entry, count in counts if count > 0]
    return tuple(e for e in lacking if judged(e)), tuple(e for e in lacking if not judged(e))


def merged(found: Iterable[Accepted], kept: Iterable[Accepted]) -> Baseline:
    """Return the baseline with the found and kept entries; counts of equal fingerprints are added."""
    counts: Counter[Fingerprint] = Counter()
    files: dict[Fingerprint, set[str]] = {}
    for entry in (*found, *kept):
        counts[entry.fingerprint] += entry.count
        files.setdefault(entry.fingerprint, set()).update(entry.files)
    ordered = sorted(counts, key=lambda f: (isinstance(f, OfHazard), f.texts()))
    return Baseline(tuple(Accepted(f, counts[f], tuple(sorted(files[f]))) for f in ordered))


def load(path: Path) -> Baseline:
    """Read a baseline. Raises BaselineError if the file is damaged, not a baseline, or of another format version."""
    import json  # most runs have no baseline, and need no JSON

    try:
        document = json.loads(
            path.read_bytes().decode("utf-8-sig", "surrogateescape")
        )  # a file name on Linux need not be valid UTF-8
    except FileNotFoundError:
        raise BaselineError(
            f"The baseline {shown(path)} does not exist: create it with --write-baseline, "
            "or ignore it with --no-baseline."
        ) from None
    except OSError as error:
        raise BaselineError(f"The baseline {shown(path)} cannot be read: {error.strerror}.") from None
    except ValueError as error:
        raise BaselineError(f"The baseline {shown(path)} is damaged ({error}): {_REMEDY}") from None
    if not isinstance(document, dict) or document.get("tool") != "tarl-lint":
        raise BaselineError(
            f"{shown(path)} is not a baseline of tarl-lint: name another file with --baseline."
        )
    version = document.get("format")
    if version != FORMAT_VERSION:
        raise BaselineError(
            f"The baseline {shown(path)} has format {version}, this tarl-lint reads {FORMAT_VERSION}: "
            "use the tarl-lint that wrote it, or delete it and run --write-baseline."
        )
    try:
        flows = [_flow(entry) for entry in document["flows"]]
        return merged([*flows, *(_hazard(entry) for entry in document.get("hazards", ()))], ())
    except (KeyError, TypeError, ValueError) as error:
        raise BaselineError(f"The baseline {shown(path)} is damaged ({_reason(error)}): {_REMEDY}") from None


_REMEDY: Final = "restore it from version control, or delete it and run --write-baseline."
_FLOW: Final = {
    "source": "source",
    "callback": "callback",
    "sink": "sink",
    "in": "place",
    "class": "owner",
    "package": "package",
}  # key in the file → field of the dataclass
_HAZARD: Final = {"rule": "rule", "about": "about", "in": "place", "package": "package"}


def _flow(entry: Any) -> Accepted:
    kind = entry["kind"]
    if kind not in ("explicit", "implicit"):
        raise ValueError(f"an entry has the kind {kind!r}")
    return _accepted(OfFlow(kind=kind, **_texts(entry, _FLOW)), entry)


def _hazard(entry: Any) -> Accepted:
    return _accepted(OfHazard(**_texts(entry, _HAZARD)), entry)


def _texts(entry: Any, fields: Mapping[str, str]) -> dict[str, Any]:
    texts = {field: entry[key] for key, field in fields.items()}
    if not all(isinstance(text, str) for text in (*texts.values(), *entry["files"])):
        raise ValueError("an entry has a value that is not a string")
    return texts


def _accepted(fingerprint: Fingerprint, entry: Any) -> Accepted:
    count = entry["count"]
    if type(count) is not int or count < 1:
        raise ValueError(f"an entry has the count {count!r}")
    return Accepted(fingerprint, count, tuple(entry["files"]))


def _reason(error: Exception) -> str:
    if not isinstance(error, KeyError):
        return str(error)
    what = "it" if error.args[0] == "flows" else "an entry"
    return f"{what} lacks {error.args[0]!r}"


def dumps(baseline: Baseline) -> str:
    """Return the text of the file: one finding per line, in words, so that a review shows additions and removals."""
    flows = [_words(entry, _FLOW) for entry in baseline.entries if isinstance(entry.fingerprint, OfFlow)]
    hazards = [
        _words(entry, _HAZARD) for entry in baseline.entries if isinstance(entry.fingerprint, OfHazard)
    ]
    parts = f' "flows": {_array(flows)}' + (f',\n "hazards": {_array(hazards)}' if hazards else "")
    return f'{{"format": {FORMAT_VERSION}, "tool": "tarl-lint",\n{parts}}}\n'


def _array(entries: Sequence[Mapping[str, Any]]) -> str:
    import json

    lines = ",\n".join(f"  {json.dumps(entry, ensure_ascii=False)}" for entry in entries)
    return f"[\n{lines}\n ]" if lines else "[]"


def _words(entry: Accepted, fields: Mapping[str, str]) -> dict[str, Any]:
    key = entry.fingerprint
    kind = {"kind": key.kind} if isinstance(key, OfFlow) else {}
    texts = {name: getattr(key, field) for name, field in fields.items()}
    return {**kind, **texts, "count": entry.count, "files": list(entry.files)}


def save(path: Path, baseline: Baseline) -> None:
    """Write a baseline atomically. Raises BaselineError if the file cannot be written."""
    try:
        write_atomically(path, dumps(baseline).encode("utf-8", "surrogateescape"), through_links=True)
    except OSError as error:
        raise BaselineError(
            f"The baseline {shown(path)} cannot be written: {error.strerror}. Name another with --baseline."
        ) from None
