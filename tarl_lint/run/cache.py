"""Cache of results by content, settings and version. A problem with the cache never fails a run.

One file contains the entries of the last run on the same paths with the same settings. The first line of the file
is the digest of the rest, so a damaged file is not read. The file is written under another name and then renamed.
If several runs write at the same time, the last one replaces the file of the others.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final, TypeVar

from tarl_lint import __version__
from tarl_lint.files import write_atomically
from tarl_lint.model import Cut, Finding, Flow, Sink, SiteId, Source, Span, Step
from tarl_lint.read.source import Script, SourceError
from tarl_lint.read.watched import Reading
from tarl_lint.settings.config import Config

try:
    from _blake2 import blake2b  # hashlib imports OpenSSL, which takes longer than linting a small file
except ImportError:
    from hashlib import blake2b

T = TypeVar("T")

FORMAT: Final = 1 + 4
PLACE: Final = (".tarl", "cache", "lint")
PACKAGES: Final = (
    "flows", "interpret", "ir", "memory", "models", "models/ros", "prefilter", "read", "rules", "rules/limits",
    "rules/races", "run", "settings", "system",
)  # fmt: skip
AFTERWARDS: Final = frozenset(
    ["root", "exclude", "baseline", "fail_on", "per_file_ignores", "file", "origins"]
)  # settings that do not influence the findings in given files


@dataclass(frozen=True)
class Report:
    """The results for a group of files: findings without fingerprints, and files that could not be analysed.

    `cut` are the programs that exhausted their budget. `ended` are the classes outside the files at which flows
    ended.
    """

    findings: tuple[Finding, ...] = ()
    errors: tuple[SourceError, ...] = ()
    cut: tuple[Cut, ...] = ()
    ended: tuple[str, ...] = ()


class Cache:
    """Reports by key, and plans: the keys of a whole run. Without a file, nothing is stored.

    `spare` is the number of entries that are kept although a run does not use them. With `adapts`, the cache adapts
    reports to edits.
    """

    adapts = False

    def __init__(self, file: Path | None, spare: int = 0) -> None:
        self._file = file
        self._spare = spare
        self._reports: dict[str, Any] = {}
        self._plans: dict[str, list[str]] = {}
        self._used: dict[str, Any] = {}
        self._plan: tuple[str, list[str]] | None = None
        if file is not None:
            self._load(file)

    def report(self, key: str) -> Report | None:
        """Return the report stored under a key; None if there is none."""
        packed = self.entry(key)
        if packed is None:
            return None
        findings, errors, cut, ended = packed
        found = tuple(unpacked(Finding, f) for f in findings)
        return Report(
            found, tuple(SourceError(*e) for e in errors), tuple(Cut(*c) for c in cut), tuple(ended)
        )

    def put(self, key: str, report: Report) -> None:
        """Store a report, unless it contains an internal error, because the next version may no longer have this error.

        Without a file, nothing is stored, since no later run can read it.
        """
        if self._file is not None and not any(error.bug for error in report.errors):
            parts = packed(report.findings), packed(report.errors), packed(report.cut), list(report.ended)
            self.put_entry(key, list(parts))

    def adapted(self, scripts: Sequence[Script]) -> Report | None:  # noqa: ARG002 - used by the cache of the editor
        """Return a report for earlier texts of the files that is still valid; None if there is none."""
        return None

    def edited(self, digests: Mapping[str, str]) -> frozenset[str]:  # noqa: ARG002 - used by the cache of the editor
        """Return the files whose digests differ from the last run; empty if there was no last run."""
        return frozenset()

    def keep(self, scripts: Sequence[Script], readings: Mapping[str, Reading], report: Report) -> None:
        """Keep the parts that the analysis has read to make a report, if the cache `adapts` reports."""

    def entry(self, key: str) -> Any:
        """Return the entry stored under a key; None if there is none."""
        found = self._reports.get(key)
        if found is not None:
            self._used[key] = found
        return found

    def put_entry(self, key: str, entry: object) -> None:
        """Store lists, strings and numbers under a key."""
        if self._file is not None:
            self._used[key] = entry

    def plan(self, key: str) -> Sequence[str]:
        """Return the keys of the reports of a whole run; empty if one of them is missing."""
        keys = self._plans.get(key, [])
        return keys if all(k in self._reports for k in keys) else []

    def put_plan(self, key: str, keys: Sequence[str]) -> None:
        """Store the keys of the reports of a whole run."""
        self._plan = (key, list(keys))

    def save(self) -> None:
        """Write the entries used in this run, if they differ from the file."""
        unused = [key for key in self._reports if key not in self._used]
        new = self._used.keys() - self._reports.keys()
        if self._file is None or (self._plan is None and not new and len(unused) <= self._spare):
            return
        plans = dict([self._plan]) if self._plan is not None else self._plans
        entries = {**{key: self._reports[key] for key in unused[-self._spare or len(unused) :]}, **self._used}
        text = json.dumps([entries, plans], ensure_ascii=True, separators=(",", ":"))
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True)
            ignore = self._file.parent / ".gitignore"
            if not ignore.exists():
                write_atomically(ignore, b"*\n")
            write_atomically(self._file, f"{digest([text])}\n{text}".encode("ascii"))
        except OSError:
            self._file = None  # the directory is not writable: continue without a stored cache

    def _load(self, file: Path) -> None:
        try:
            stated, _, text = file.read_text("utf-8").partition("\n")
            kept = json.loads(text) if stated == digest([text]) else None
        except (OSError, ValueError, RecursionError):
            return  # the file is missing or damaged, so start with an empty cache
        if isinstance(kept, list) and [type(part) for part in kept] == [dict, dict]:
            self._reports, self._plans = kept


def opened(paths: Sequence[Path], config: Config, of: str = "", spare: int = 0) -> Cache:
    """Return the cache of runs on these paths with these settings; `of` selects another kind of entries."""
    settings = [f"{f.name}={getattr(config, f.name)!r}" for f in fields(config) if f.name not in AFTERWARDS]
    places = [os.path.abspath(p) for p in paths]  # noqa: PTH100 - paths stay strings, and need not exist
    here = os.getcwd()  # noqa: PTH109
    name = digest([str(FORMAT), __version__, sys.version, *_ourselves(), *settings, here, *places])
    return Cache((config.root or Path.cwd()).joinpath(*PLACE, f"{of}{name}.json"), spare)


def digest(texts: Iterable[str]) -> str:
    """Return a digest of a sequence of strings."""
    made = blake2b(digest_size=16)
    for text in texts:
        data = text.encode("utf-8", "surrogatepass")
        made.update(len(data).to_bytes(8, "big"))
        made.update(data)
    return made.hexdigest()


def _ourselves() -> list[str]:
    """Return the identity of this copy of the linter, which changes with its source during development."""
    home = Path(__file__).parent.parent
    found = []
    for place in (home, *(home / name for name in PACKAGES)):
        with os.scandir(place) as entries:
            files = [(e.name, e.stat()) for e in entries if e.name.endswith(".py")]
        found += [f"{name} {stat.st_mtime_ns} {stat.st_size}" for name, stat in sorted(files)]
    return found


def packed(value: object) -> object:
    """Return dataclasses as lists of their fields."""
    if isinstance(value, tuple):
        return [packed(item) for item in value]
    if isinstance(value, frozenset):
        return sorted(value)
    names = getattr(value, "__dataclass_fields__", None)
    return [packed(getattr(value, name)) for name in names] if names is not None else value


def unpacked(kind: type[T], values: Sequence[Any]) -> T:
    """Return a dataclass from its packed fields."""
    names = getattr(kind, "__dataclass_fields__", {})
    made = (PARTS.get(name, _same)(value) for name, value in zip(names, values, strict=True))
    return kind(*made)


def _same(value: Any) -> Any:
    return value


def _spans(packed: Any) -> tuple[Span, ...]:
    return tuple(Span(*span) for span in packed)


PARTS: Final[Mapping[str, Callable[[Any], Any]]] = {
    "span": lambda packed: Span(*packed),
    "site": lambda packed: SiteId(*packed),
    "topics": tuple,
    "default_topics": tuple,
    "chain": tuple,
    "registered": _spans,
    "via": _spans,
    "source": lambda packed: unpacked(Source, packed),
    "sink": lambda packed: unpacked(Sink, packed),
    "steps": lambda packed: tuple(Step(SiteId(*site), Span(*span), *rest) for site, span, *rest in packed),
    "flow": lambda packed: None if packed is None else unpacked(Flow, packed),
}  # name of a field → function that converts its packed value
