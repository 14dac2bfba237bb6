"""The extra `pytest`: what the plugin and the commands need beyond the linter, and what to say where it is missing."""

from __future__ import annotations

from importlib.util import find_spec

INSTALL = 'pip install "tarl[pytest]"'
NEEDED = ("greenlet", "libcst", "numpy", "pytest")


def missing_packages() -> list[str]:
    """Return the packages of the extra `pytest` that are not installed, by name. Nothing is imported."""
    return [name for name in NEEDED if find_spec(name) is None]


def missing_extra(what: str) -> str | None:
    """Return a sentence saying that `what` needs the extra `pytest`, or None where all of it is installed."""
    missing = missing_packages()
    if not missing:
        return None
    verb = "is" if len(missing) == 1 else "are"
    return f"{what} needs {_listed(missing)}, which {verb} not installed: run {INSTALL}."


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
