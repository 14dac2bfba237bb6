"""Find the sources of the installed packages in the settings; they are read from a virtual environment.

Nothing is imported. Only `pyvenv.cfg`, site-packages and lines with paths in `.pth` files are read; lines with code
are ignored.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from tarl_lint.errors import ConfigError
from tarl_lint.files import shown
from tarl_lint.model import Finding
from tarl_lint.prefilter.by_words import reached
from tarl_lint.read import source
from tarl_lint.read.source import Script
from tarl_lint.run.cache import Report
from tarl_lint.settings.config import Config

MOST_FILES: Final = 5_000  # maximum number of files that are read from one package
SITES: Final = ("lib/python3*/site-packages", "lib64/python3*/site-packages", "Lib/site-packages")
SYSTEM_SITES: Final = (*SITES, "lib/python3/dist-packages", "lib/python3*/dist-packages")


@dataclass(frozen=True)
class Followed:
    """The analysed files of installed packages, the versions of these packages, and messages for missing packages."""

    scripts: tuple[Script, ...] = ()
    packages: tuple[str, ...] = ()  # names with versions, such as "robot_base 1.4.0"
    missing: tuple[str, ...] = ()


def follow(scripts: Sequence[Script], config: Config) -> Followed:
    """Return the files of the named packages that `scripts` import, directly or indirectly.

    Raises ConfigError if no virtual environment is named, or the named directory is not one.
    """
    if not config.follow_installed:
        return Followed()
    if not config.python:
        raise ConfigError(
            "'follow-installed' needs 'python', the virtual environment that holds the packages: python = \".venv\"."
        )
    home = (config.root or Path.cwd()) / config.python
    sites = search_path(home)
    found: list[Script] = []
    packages: list[str] = []
    missing: list[str] = []
    for name in config.follow_installed:
        files = [script for site in sites for script in _scripts(site, name)][:MOST_FILES]
        if not files:
            missing.append(
                f"'follow-installed' names {name!r}, but {shown(home)} contains no Python source of it: install it "
                "there, or remove the name."
            )
            continue
        found += files
        packages.append(f"{name} {version(sites, name)}".rstrip())
    kept = reached(scripts, found)
    return Followed(tuple(kept), tuple(packages), tuple(missing))


def without(report: Report, followed: Followed) -> Report:
    """Return a report without the flows that lie entirely in installed packages."""
    theirs = {script.path for script in followed.scripts}
    if not theirs:
        return report
    findings = tuple(f for f in report.findings if _ours(f, theirs))
    return replace(
        report,
        findings=findings,
        errors=tuple(e for e in report.errors if e.path not in theirs),
        cut=tuple(c for c in report.cut if c.path not in theirs),
    )


def _ours(finding: Finding, theirs: Set[str]) -> bool:
    if finding.flow is None:
        return finding.span.path not in theirs
    steps = (s for s in finding.flow.steps if s.dependence != "context")
    places = (finding.flow.source.span, finding.flow.sink.span, *(s.span for s in steps))
    return any(place.path not in theirs for place in places)


def search_path(home: Path) -> list[Path]:
    """Return the directories in which a virtual environment finds packages.

    Raises ConfigError if the directory is not a virtual environment.
    """
    try:
        text = (home / "pyvenv.cfg").read_text("utf-8", errors="replace")
    except OSError:
        raise ConfigError(
            f"'python' is {shown(home)}, which is not a virtual environment: it contains no pyvenv.cfg."
        ) from None
    settings = dict(re.findall(r"^\s*([\w-]+)\s*=\s*(.*?)\s*$", text, re.MULTILINE))
    sites = [site for pattern in SITES for site in sorted(home.glob(pattern))]
    if settings.get("include-system-site-packages", "").lower() == "true" and settings.get("home"):
        prefix = Path(settings["home"]).parent
        sites += [site for pattern in SYSTEM_SITES for site in sorted(prefix.glob(pattern))]
    distinct = {site.resolve(): site for site in reversed(sites)}
    sites = [site for site in sites if distinct[site.resolve()] is site]
    return [*sites, *(place for site in sites for place in _listed(site))]


def _listed(site: Path) -> Iterator[Path]:
    """Yield the directories that `.pth` files add, for example for editable installs; lines with code are ignored."""
    for file in sorted(site.glob("*.pth")):
        try:
            lines = file.read_text("utf-8", errors="replace").splitlines()
        except OSError:
            continue
        for line in lines:
            place = line.strip()
            if place and not re.match(r"#|import[ \t]", place) and (site / place).is_dir():
                yield site / place


def _scripts(site: Path, name: str) -> Iterator[Script]:
    """Yield the sources of a package or single-file module; compiled modules stay opaque."""
    top = site / name
    files = sorted(top.rglob("*.py")) if (top / "__init__.py").is_file() else [site / f"{name}.py"]
    for file in files:
        data = source.contents(file, shown(file)) if file.is_file() else None
        if isinstance(data, bytes):
            parts = file.relative_to(site).with_suffix("").parts
            is_package = parts[-1] == "__init__"
            dotted = ".".join(parts[:-1] if is_package else parts)
            script = source.read(shown(file), data, dotted)
            if isinstance(script, Script):
                yield replace(script, is_package=is_package, installed=True)


def version(sites: Iterable[Path], name: str) -> str:
    """Return the version of the distribution that contains a package; "" if it is unknown."""
    for site in sites:
        for directory in sorted(site.glob("*.dist-info")):
            if _holds(directory, name):
                return _field(directory / "METADATA", "Version")
    return ""


def _holds(directory: Path, name: str) -> bool:
    named = directory.name.partition("-")[0].lower()
    listed = _text(directory / "top_level.txt").split()
    recorded = re.search(rf"^{re.escape(name)}(/|\.py,)", _text(directory / "RECORD"), re.MULTILINE)
    return name in listed or recorded is not None or named == name.lower()


def _field(file: Path, field: str) -> str:
    found = re.search(rf"^{field}:\s*(\S+)", _text(file), re.MULTILINE)
    return found[1] if found else ""


def _text(file: Path) -> str:
    try:
        return file.read_text("utf-8", errors="replace")
    except OSError:
        return ""
