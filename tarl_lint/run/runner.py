"""One run: discover files, parse and analyse them, silence findings, subtract the baseline.

A file that cannot be processed becomes an error entry.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

from tarl_lint import baseline, suppress
from tarl_lint.baseline import Accepted, Baseline
from tarl_lint.errors import AnalysisBug, UsageError
from tarl_lint.fingerprints import Fingerprint, of_finding
from tarl_lint.model import CODES, OFF_BY_DEFAULT, RULES, Cut, Finding, Kind
from tarl_lint.prefilter.by_words import concerned
from tarl_lint.read import discover, installed, module_names, source
from tarl_lint.read.discover import Discovery, Notes, SourceFile
from tarl_lint.read.installed import Followed
from tarl_lint.read.layout import Layout
from tarl_lint.read.source import Script, SourceError
from tarl_lint.run import cache, groups
from tarl_lint.run.cache import Cache, Report
from tarl_lint.run.groups import Partly
from tarl_lint.run.progress import Tell, silent
from tarl_lint.settings.config import Config, Options
from tarl_lint.settings.per_file import FileIgnores
from tarl_lint.settings.unmatched import unmatched
from tarl_lint.suppress import Suppression

UNREADABLE: Final = "TARL001"
ARCHITECTURE: Final = "TARL3"  # beginning of the codes of rules that examine launched systems
HAZARDS: Final = ("TARL2", ARCHITECTURE)  # beginnings of the codes of hazards
NO_BUFFERS: Final[Mapping[Path, bytes]] = MappingProxyType({})


@dataclass(frozen=True)
class Statistics:
    """Counts of one run: analysed files and lines, skipped files, programs that exhausted their budget."""

    files: int = 0
    lines: int = 0
    notes: Notes = field(default_factory=Notes)
    cut: tuple[Cut, ...] = ()


@dataclass(frozen=True)
class Result:
    """The result of a run, from which all reports are made.

    `findings` are sorted by place and have a fingerprint and a status; `silenced` are the findings that comments
    silence. `found` are the findings in the form of a baseline. `vanished` and `kept` are the other entries of the
    baseline. `unmatched` are messages about settings without effect. `followed` are the installed packages that
    were analysed. `ended` are the classes outside the files at which flows ended. `texts` maps paths to the texts
    of the files. `has_endpoints` is false if no file contains a word used to subscribe or publish. `left_out` is
    the number of findings that `per-file-ignores` disables. `off_by_default` is the number of findings of rules
    that are off by default. If `names_errors` is False, text reports give the number of unreadable files without
    listing them. `kinds` are the kinds of flows that were requested. `reports_hazards` and `follows_clients` say
    whether hazards and clients were requested. Codes in `failing` fail the run.
    """

    findings: tuple[Finding, ...] = ()
    silenced: tuple[Finding, ...] = ()
    errors: tuple[SourceError, ...] = ()
    found: tuple[Accepted, ...] = ()
    vanished: tuple[Accepted, ...] = ()
    kept: tuple[Accepted, ...] = ()
    unused: tuple[Suppression, ...] = ()
    unmatched: tuple[str, ...] = ()
    followed: tuple[str, ...] = ()
    ended: tuple[str, ...] = ()
    texts: Mapping[str, str] = field(default_factory=dict)
    statistics: Statistics = field(default_factory=Statistics)
    has_endpoints: bool = True
    baseline: Path | None = None
    names_errors: bool = True
    left_out: int = 0
    off_by_default: int = 0
    kinds: tuple[Kind, ...] = ("explicit", "implicit")
    reports_hazards: bool = True
    follows_clients: bool = True
    failing: frozenset[str] = frozenset()

    @property
    def new(self) -> tuple[Finding, ...]:
        """Return the findings that are not in the baseline."""
        return tuple(f for f in self.findings if f.status == "new")


Early = Callable[[Result, frozenset[str]], None]


def run(
    options: Options,
    config: Config,
    tell: Tell = silent,
    buffers: Mapping[Path, bytes] = NO_BUFFERS,
    known: Cache | None = None,
    early: Early | None = None,
) -> Result:
    """Lint the files at and below the paths, reporting progress to `tell`.

    `buffers` maps absolute paths to the texts of unsaved files in an editor; `known` is a cache to use instead of the
    one on disk. `early` gets incomplete results while programs are still to be analysed, with the paths of the files
    whose findings are final.

    Raises UsageError if there is nothing to lint, BaselineError if the baseline is unusable, AnalysisBug if the
    analysis crashed.
    """
    tell("Looking for files")
    discovery = discover.find(options.paths, config, options.stdin)
    if not discovery.files:
        raise UsageError(_nothing(options.paths, discovery.notes))
    accepted = _accepted(options, config)
    if options.stdin is not None:
        buffers = {**buffers, options.stdin.path.absolute(): options.stdin.data}
    scripts, unread = read(discovery.files, buffers, tell)
    followed = installed.follow(scripts, config)
    files = _Files(discovery, scripts, unread, followed, accepted)

    def partly(report: Report, settled: frozenset[str]) -> None:
        if early is not None:
            early(_result(report, files, config), settled)

    everything = (*scripts, *followed.scripts)
    report = _examine(everything, options, config, tell, known, None if early is None else partly)
    return _result(report, files, config)


@dataclass(frozen=True)
class _Files:
    """The files of a run as they were read, and the baseline."""

    discovery: Discovery
    scripts: tuple[Script, ...]
    unread: tuple[SourceError, ...]
    followed: Followed
    accepted: Baseline


def _result(report: Report, files: _Files, config: Config) -> Result:
    """Return the result of a run: silence findings and subtract the baseline."""
    scripts, followed, accepted = files.scripts, files.followed, files.accepted
    report = installed.without(report, followed)
    errors = tuple(sorted((*files.unread, *report.errors), key=lambda e: (e.path, e.line)))
    found_in = {finding.span.path for finding in report.findings}
    broken = {error.path for error in errors if not error.bug} - found_in
    texts = {script.path: script.text for script in scripts if script.path not in broken}
    beside = {script.path: script.text for script in followed.scripts}
    identities = _Identities(files.discovery.files, config)
    marked = tuple(identities.mark(f) for f in report.findings)
    wanted = tuple(f for f in marked if config.enabled(f.code))
    heard, silenced, unused = suppress.apply(wanted, texts)
    elsewhere = FileIgnores(config.root or Path.cwd(), config.per_file_ignores)
    reported = [f for f in heard if not elsewhere.silences(f)]
    findings = baseline.subtract(reported, accepted.counts())
    unasked = {f.fingerprint for f in marked if f.code in OFF_BY_DEFAULT and not config.enabled(f.code)}
    judged = _judge(files.discovery.files, errors, config, unasked)
    vanished, kept = baseline.missing(accepted, Counter(f.fingerprint for f in wanted), judged)
    lines = sum(text.count("\n") for text in texts.values())
    return Result(
        findings=tuple(sorted(findings, key=_place)),
        silenced=tuple(sorted(silenced, key=_place)),
        errors=errors,
        found=identities.entries(findings),
        vanished=vanished,
        kept=kept,
        unused=tuple(s for s in unused if _in_vain(s, config)),
        unmatched=(*unmatched(config, texts.values()), *followed.missing),
        followed=followed.packages,
        ended=module_names.unfollowed(report.ended),
        texts={**texts, **beside},
        statistics=Statistics(len(texts), lines, files.discovery.notes, report.cut),
        has_endpoints=bool(report.findings) or not texts or concerned(scripts, config),
        baseline=config.baseline if accepted.entries else None,
        names_errors=config.enabled(UNREADABLE),
        left_out=len(heard) - len(reported),
        off_by_default=sum(f.fingerprint in unasked for f in marked),
        kinds=tuple(kind for kind, code in CODES.items() if config.enabled(code)),
        reports_hazards=any(config.enabled(rule) for rule in RULES if rule.startswith("TARL2")),
        follows_clients=config.clients,
        failing=failing(findings, config),
    )


def _in_vain(comment: Suppression, config: Config) -> bool:
    """Return whether all rules that a comment may silence are enabled.

    A comment without a code silences the default rules. Rules of architecture need `--launch`.
    """
    if comment.code.startswith(ARCHITECTURE):
        return False
    rules = comment.rules if comment.code else [r for r in comment.rules if r not in OFF_BY_DEFAULT]
    return all(map(config.enabled, rules))


def exceeds(result: Result, config: Config) -> bool:
    """Return whether the findings fail the run according to `fail_on`."""
    return bool(failing(result.new, config))


def failing(findings: Sequence[Finding], config: Config) -> frozenset[str]:
    """Return the codes of new findings for which `fail_on` fails the run; each level includes the earlier levels."""
    codes = {f.code for f in findings if f.status == "new"}
    hazards = {code for code in codes if code.startswith(HAZARDS)}
    levels = {
        "never": set[str](),
        "hazard": hazards,
        "explicit": hazards | (codes & {CODES["explicit"]}),
        "implicit": hazards | (codes & {*CODES.values(), *OFF_BY_DEFAULT}),
    }
    return frozenset(levels[config.fail_on])


def read(
    files: Sequence[SourceFile], buffers: Mapping[Path, bytes] = NO_BUFFERS, tell: Tell = silent
) -> tuple[tuple[Script, ...], tuple[SourceError, ...]]:
    """Read the files; an unreadable one becomes an error entry."""
    tell(f"Reading {len(files)} {'file' if len(files) == 1 else 'files'}")
    found = [_read(file, buffers) for file in files]
    scripts = tuple(f for f in found if isinstance(f, Script))
    return scripts, tuple(f for f in found if isinstance(f, SourceError))


def _read(file: SourceFile, buffers: Mapping[Path, bytes]) -> Script | SourceError:
    data = source.contents(file.path, file.shown, buffers.get(file.path))
    if isinstance(data, SourceError):
        return data
    found = source.read(file.shown, data, file.name)
    if isinstance(found, Script) and (found.is_package, found.started) != (file.is_package, file.started):
        return replace(found, is_package=file.is_package, started=file.started)
    return found


def _examine(
    scripts: Sequence[Script],
    options: Options,
    config: Config,
    tell: Tell,
    known: Cache | None,
    partly: Partly | None,
) -> Report:
    keeps = options.cache and options.stdin is None
    try:
        if known is None:
            known = cache.opened(options.paths, config) if keeps else Cache(None)
        return groups.examine(scripts, config, known, options.jobs, tell, partly)
    except Exception as error:
        if groups.debugging():
            raise
        import traceback

        last = traceback.extract_tb(error.__traceback__)[-1]
        what = f"{type(error).__name__}: {error}".rstrip(": ")
        raise AnalysisBug(
            f"tarl-lint has a bug and could not finish ({what}, {Path(last.filename).name}:{last.lineno}). "
            "Please report it with the traceback from TARL_DEBUG=1; until it is fixed, --exclude may "
            "leave out the cause."
        ) from None


def _accepted(options: Options, config: Config) -> Baseline:
    """Load the baseline, if there is one. The baseline may be missing if this run writes it."""
    path = config.baseline
    if path is None or (options.write_baseline and not path.exists()):
        return Baseline()
    return baseline.load(path)


class _Identities:
    """Computes the fingerprints of findings. They depend on the ROS package and on the place of the baseline."""

    def __init__(self, files: Sequence[SourceFile], config: Config) -> None:
        self._files = {file.shown: file for file in files}
        self._layout = Layout()
        self._directory = _home(config)
        self._by_digest: dict[str, Fingerprint] = {}

    def mark(self, finding: Finding) -> Finding:
        """Return a finding with its fingerprint."""
        file = self._files.get((finding.flow.source if finding.flow else finding).span.path)
        package = self._layout.ros_package(str(file.path)) if file else ""
        fingerprint = of_finding(finding, package, file.name if file else "")
        digest = fingerprint.digest()
        self._by_digest[digest] = fingerprint
        return replace(finding, fingerprint=digest, package=fingerprint.package)

    def entries(self, findings: Sequence[Finding]) -> tuple[Accepted, ...]:
        """Return the findings as entries of a baseline."""
        each = (Accepted(self._by_digest[f.fingerprint], 1, self._places(f)) for f in findings)
        return baseline.merged(each, ()).entries

    def _places(self, finding: Finding) -> tuple[str, ...]:
        """Return the files of a finding, relative to the baseline."""
        flow = finding.flow
        shown = {flow.source.span.path, flow.sink.span.path} if flow else {finding.span.path}
        files = ((path, self._files.get(path)) for path in shown)
        places = (file.path if file else Path(path) for path, file in files)
        return tuple(sorted(Path(os.path.relpath(place, self._directory)).as_posix() for place in places))


def _home(config: Config) -> Path:
    """Return the base directory of file names in the baseline."""
    return config.baseline.absolute().parent if config.baseline else Path.cwd()


def _judge(
    files: Sequence[SourceFile], errors: Sequence[SourceError], config: Config, unasked: Set[str]
) -> Callable[[Accepted], bool]:
    """Return a function that returns whether an accepted finding is gone, as far as this run can judge.

    `unasked` are the fingerprints of findings of rules that are off by default. Older baselines contain such
    findings.
    """
    home = _home(config)

    @lru_cache(maxsize=1)  # computed at the first use, because a baseline without entries never needs the set
    def analysed() -> set[str]:
        unreadable = {error.path for error in errors}
        return {os.path.realpath(f.path) for f in files if f.shown not in unreadable}

    def settled(name: str) -> bool:
        place = home / name
        return os.path.realpath(place) in analysed() or not place.exists()

    def judged(entry: Accepted) -> bool:
        if entry.fingerprint.code.startswith(ARCHITECTURE):
            # without --launch, TARL3 findings cannot be judged
            return False
        asked = config.enabled(entry.fingerprint.code) and entry.fingerprint.digest() not in unasked
        return asked and all(map(settled, entry.files))

    return judged


def _place(finding: Finding) -> tuple[object, ...]:
    """Return the sort key: publish call, then rule, then subscription."""
    source = (finding.flow.source.span,) if finding.flow else ()
    return (finding.span, finding.code, source, finding.message)


def _nothing(paths: Sequence[Path], notes: Notes) -> str:
    places = ", ".join(path.as_posix() for path in paths)
    nodes = (
        f" (there are {notes.cpp_nodes} C++ nodes, which tarl-lint does not read)" if notes.cpp_nodes else ""
    )
    return (
        f"There is no Python file to lint in {places}{nodes}: name a file, or a directory with Python files. "
        "Hidden and installed files, and those that .gitignore or exclude match, are skipped."
    )
