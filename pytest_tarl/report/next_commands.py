"""Suggest commands that repeat the comparison or take the next step."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

from pytest_tarl.model import Comparison


def command(comparison: Comparison, *flags: str) -> str:
    """Return the command that repeats the comparison with the same seed."""
    drift = ["--tarl-drift", comparison.drift] if comparison.drift else []
    seed = ["--tarl-seed", str(comparison.seed)] if comparison.seed else []
    options = [*drift, *seed, *comparison.flags, *flags]
    test = comparison.node or comparison.target or comparison.test
    return shlex.join(["pytest", test, "--tarl-online", *options])


def recording(comparison: Comparison) -> str:
    """Return the command that records the new design once a permanent drift is repaired."""
    drift = ["--tarl-drift", comparison.drift] if comparison.drift else []
    return shlex.join(["pytest", comparison.target or comparison.test, "--tarl-record", *drift])


def repeat(comparison: Comparison) -> str:
    """Return the command that repeats the whole run, including searches."""
    searches = [search.method for search in comparison.searches if search.method != "structure"]
    methods = [method for method in searches if method != "ranking"]
    full = ["--tarl-localize", "full"] if len(methods) < len(searches) else []
    chosen = (
        [flag for method in methods for flag in ("--tarl-search", method)] if methods != ["sweep"] else []
    )
    return command(comparison, *(["--tarl-repair", *chosen, *full] if comparison.repair else []))


def next_steps(comparison: Comparison) -> Iterator[str]:
    """Yield the next command for the developer, if any."""
    if not comparison.lists:
        yield shlex.join(["pytest", comparison.target or comparison.test, "--tarl-record"])
    elif comparison.repair and comparison.repair.accepted and comparison.repair.patch:
        yield shlex.join(["tarl", "apply", f"{_folder(comparison)}{comparison.repair.patch}"])
        if comparison.permanent:
            yield recording(comparison)
    elif _repairable(comparison):
        yield command(comparison, "--tarl-repair")


def _folder(comparison: Comparison) -> str:
    """Return the path from pytest's start folder to the root, or an empty text."""
    target = comparison.target
    return target.removesuffix(comparison.test) if target.endswith(comparison.test) else ""


def _repairable(comparison: Comparison) -> bool:
    """Return whether a repair is possible and was not searched yet."""
    verdict = comparison.verdict
    lost = verdict.result == "degraded" and not verdict.failures_only
    return lost and comparison.repair is None and not _happened(comparison)


def _happened(comparison: Comparison) -> bool:
    """Return whether the missions come from a log or from bags."""
    return bool({"--tarl-log", "--tarl-bag"} & {*comparison.flags})
