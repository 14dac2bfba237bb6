"""A run's options after checking, as a frozen dataclass; this module does not import pytest."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pytest_tarl import processors
from pytest_tarl.errors import SettingsError

Mode = Literal["plain", "record", "online", "repair", "stress"]
SEARCHES = ("sweep", "halving", "epsilon-greedy")
EDITS = ("auto", "use", "definition")
RANKINGS = ("repair", "full")
UTILITIES = ("batch", "sarsa", "expected-sarsa", "td-lambda")
ROS_KINDS = ("embedded", "real", "auto")
MOST_EPISODES = 10**6  # upper limit of --tarl-budget
FEWEST_SHARED = 10  # lower limit of --tarl-total
_NOT_SHARED = {
    "episodes": "the first is the number for all comparisons together, the second for each one",
    "repair": "the search for a repair runs during its test. Compare first, then repair the degraded tests",
    "holm": "Holm's method needs smaller p-values than those at which a comparison may end early",
    "log": "the number of recorded missions is fixed",
    "bag": "the number of recorded missions is fixed",
}  # flags that contradict --tarl-total → reason


@dataclass(frozen=True)
class Options:
    """The options of a pytest run."""

    mode: Mode = "plain"
    seed: int = 0
    drift: str | None = None
    episodes: int | None = None  # None: the marker's number for a recording, 40 for a comparison
    alpha: float = 0.05
    searches: tuple[str, ...] = ("sweep",)
    localize: str = "repair"  # what ends the search: an accepted repair, or a ranking of all sites
    budget: int = 300  # limit of a search in episodes
    seconds: float | None = None  # limit of a search in seconds, instead of episodes
    edit: str = "auto"  # where to write an unconditional repair of a named constant
    structure: bool = True  # whether a search may also change the structure of the code
    strict: bool = False
    utility: str = "batch"
    workers: int = 1  # number of parallel episodes; if more than one, each runs in its own process
    cluster: str | None = None  # address of a Dask scheduler
    ros: str = "embedded"
    looks: int | None = None  # maximum number of looks at the verdict
    log: Path | None = None  # log with a robot's missions to compare
    holm: bool = False  # whether to correct verdicts over all tests of the run
    comparisons: int = 1  # number of comparisons to correct for
    bags: tuple[Path, ...] = ()  # recorded missions to compare
    stress_budget: int = 1000  # limit of a stress run in episodes
    stress_seconds: float | None = None  # limit of a stress run in seconds, instead of episodes
    # whether a stress run also searches for a repair at the nearest drift confirmed to fail
    stress_repair: bool = False
    total: int | None = None  # number of episodes shared by all comparisons of the run
    resume: bool = False  # whether to reuse the finished episodes of an interrupted run

    ONLINE_EPISODES = 40
    LOOKS = 3

    @property
    def most_looks(self) -> int:
        """Return the maximum number of looks at the verdict.

        There is only one look if a repair follows, because finding the region takes all episodes. The same applies to
        --tarl-holm, because its correction needs smaller p-values than those at which a run may stop early.
        """
        return self.looks or (1 if self.mode == "repair" or self.holm else self.LOOKS)

    def alone(self, episodes: int) -> Options:
        """Return the options for running one comparison separately with `episodes` episodes."""
        return replace(self, total=None, looks=None, episodes=episodes)

    @property
    def learner(self) -> str:
        """Return the name of the incremental learning rule; empty for the batch solution."""
        return "" if self.utility == "batch" else self.utility

    @property
    def flags(self) -> tuple[str, ...]:
        """Return the non-default options that affect a comparison, as command line arguments."""
        chosen = {
            "--tarl-episodes": (self.episodes, None),
            "--tarl-alpha": (self.alpha, 0.05),
            "--tarl-looks": (self.looks, None),
            "--tarl-budget": (self.budget if self.seconds is None else f"{self.seconds:g}s", 300),
            "--tarl-edit": (self.edit, "auto"),
            "--tarl-utility": (self.utility, "batch"),
            "--tarl-ros": (self.ros, "embedded"),
            "--tarl-log": (self.log, None),
        }
        plain = tuple(
            text for flag, (value, usual) in chosen.items() if value != usual for text in (flag, str(value))
        )
        if not self.structure:
            plain = (*plain, "--tarl-constants")
        return (*plain, *(text for bag in self.bags for text in ("--tarl-bag", _typed(bag))))


def options(given: Mapping[str, Any]) -> Options:
    """Check the flags of a run. Raise SettingsError if one is invalid."""
    _check_modes(given)
    searches = tuple(dict.fromkeys(given["search"] or ("sweep",)))
    for name in searches:
        if not re.fullmatch(r"[\w.]+:\w+", name):  # a user's own search, imported later
            _known("--tarl-search", name, (*SEARCHES, "module:factory"))
    localize = given["localize"] or "repair"
    _known("--tarl-localize", localize, RANKINGS)
    if given["localize"] and not given["repair"]:
        raise SettingsError("--tarl-localize needs --tarl-repair: the search for a repair ranks the sites.")
    _known("--tarl-utility", given["utility"], UTILITIES)
    _known("--tarl-edit", given["edit"], EDITS)
    _known("--tarl-ros", given["ros"], ROS_KINDS)
    if given["episodes"] is not None:
        number_within("--tarl-episodes", "it", given["episodes"], int, 2, 10**6)
    if given["looks"] is not None:
        number_within("--tarl-looks", "it", given["looks"], int, 1, 5)
    if given["total"] is not None:
        _check_total(given)
    budget = _budget(str(given["budget"]))
    stress_budget = _budget(str(given["stress-budget"]), "--tarl-stress-budget", 32)
    modes: tuple[Mode, ...] = ("record", "stress", "repair", "online")
    mode = next(one for one in modes if given[one] or one == "online")
    return Options(
        mode=mode,
        seed=given["seed"],
        drift=given["drift"],
        episodes=given["episodes"],
        alpha=number_within("--tarl-alpha", "it", given["alpha"], float, 1e-6, 0.5),
        searches=searches,
        localize=localize,
        budget=budget[0],
        seconds=budget[1],
        edit=given["edit"],
        structure=not given["constants"],
        strict=given["strict"],
        utility=given["utility"],
        workers=_workers(given["workers"]),
        cluster=given["cluster"],
        ros=given["ros"],
        looks=given["looks"],
        log=_log(given),
        holm=given["holm"],
        bags=_bags(given),
        stress_budget=stress_budget[0],
        stress_seconds=stress_budget[1],
        stress_repair=bool(given["stress"] and given["repair"]),
        total=given["total"],
        resume=given["resume"],
    )


def _check_total(given: Mapping[str, Any]) -> None:
    """Raise SettingsError if --tarl-total is too small or conflicts with another flag."""
    number_within("--tarl-total", "it", given["total"], int, FEWEST_SHARED, 10**6)
    if not given["online"]:
        raise SettingsError("--tarl-total needs --tarl-online: only comparisons share episodes.")
    for other, reason in _NOT_SHARED.items():
        if given[other]:
            raise SettingsError(f"--tarl-total and --tarl-{other} cannot be used together: {reason}.")
    if given["looks"] == 1:
        raise SettingsError(
            "--tarl-total needs at least two looks, since the remaining episodes are distributed anew "
            "after each look: raise "
            "--tarl-looks, or remove it."
        )


def _check_modes(given: Mapping[str, Any]) -> None:
    """Raise SettingsError for flags that conflict, or need another flag."""
    if given["stress"]:
        _check_stress(given)
    elif not (given["record"] or given["online"] or given["repair"]):
        stray = next(
            (
                name
                for name in ("drift", "search", "localize", "strict", "log", "bag", "holm", "resume")
                if given[name]
            ),
            "drift",
        )
        also = {"drift": ", or --tarl-record for a permanent drift", "resume": " or --tarl-record"}.get(
            stray, ""
        )
        raise SettingsError(f"--tarl-{stray} needs --tarl-online{also}.")
    recorded = next((one for one in ("log", "bag") if given[one]), None)
    if given["resume"] and recorded is not None:
        raise SettingsError(
            f"--tarl-resume continues simulated episodes, but --tarl-{recorded} reads recorded missions: remove "
            "--tarl-resume."
        )
    if given["record"] and given["online"]:
        raise SettingsError("--tarl-record and --tarl-online need separate runs: record first, then compare.")
    if given["repair"] and not (given["online"] or given["stress"]):
        raise SettingsError(
            "--tarl-repair needs --tarl-online or --tarl-stress, which find the failures to repair."
        )
    if given["holm"] and not given["online"]:
        raise SettingsError("--tarl-holm needs --tarl-online: only verdicts of comparisons are corrected.")
    if given["holm"] and given["repair"]:
        raise SettingsError(
            "--tarl-holm and --tarl-repair need separate runs: verdicts are corrected after all tests, "
            "but the search for a repair runs during its test. Compare with --tarl-holm first, then "
            "repair the degraded tests."
        )


def _check_stress(given: Mapping[str, Any]) -> None:
    """Raise SettingsError for flags that --tarl-stress does not support."""
    other = next((name for name in ("record", "online") if given[name]), None)
    if other is not None:
        raise SettingsError(
            f"--tarl-stress and --tarl-{other} need separate runs: stress the test in a run of its own."
        )
    stray = next((name for name in ("search", "localize", "log", "bag", "holm") if given[name]), None)
    if stray is not None:
        raise SettingsError(f"--tarl-{stray} needs --tarl-online: remove it from the stress run.")
    if given["ros"] == "real":
        raise SettingsError("--tarl-stress needs the embedded ROS: remove --tarl-ros=real.")


def _budget(text: str, flag: str = "--tarl-budget", least: int = 1) -> tuple[int, float | None]:
    """Parse a search's limit, such as `300`, `90s`, `5min` or `1h`, into (episodes, seconds)."""
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(s|min|h)?", text.strip())
    unit = found[2] if found else None
    if found is None or float(found[1]) <= 0 or (unit is None and not found[1].isdecimal()):
        raise SettingsError(
            f"{flag}: it must be a number of episodes such as 300, or a time such as 90s or 5min, got {text!r}."
        )
    if unit is None:
        return int(number_within(flag, "it", int(found[1]), int, least, MOST_EPISODES)), None
    return MOST_EPISODES, float(found[1]) * {"s": 1, "min": 60, "h": 3600}[unit]


def _workers(text: str) -> int:
    """Return the number of parallel episodes; for `auto`, workers of pytest-xdist share the cores."""
    if text != "auto":
        return int(
            number_within("--tarl-workers", "it", int(text) if text.isdecimal() else text, int, 1, 1024)
        )
    beside = os.environ.get("PYTEST_XDIST_WORKER_COUNT", "")
    return max(1, processors.available() // (int(beside) if beside.isdecimal() and int(beside) else 1))


def _known(flag: str, name: str, among: Sequence[str]) -> None:
    if name not in among:
        close = difflib.get_close_matches(name, among, 1)
        hint = f"did you mean {close[0]!r}?" if close else f"it takes {' or '.join(among)}."
        raise SettingsError(f"{flag} does not know {name!r}; {hint}")


def _log(given: Mapping[str, Any]) -> Path | None:
    if given["log"] is None:
        return None
    if not given["online"]:
        raise SettingsError(
            "--tarl-log needs --tarl-online, which compares the missions in the log with the recording."
        )
    for other in ("repair", "drift", "episodes"):
        if given[other]:
            raise SettingsError(
                f"--tarl-log and --tarl-{other} cannot be used together: a log cannot be run again. Model "
                "its world as a "
                "drift scenario of the marker, and use that."
            )
    return Path(given["log"]).absolute()


def _typed(path: Path) -> str:
    """Return a path relative to the working directory."""
    return str(path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path)


def _bags(given: Mapping[str, Any]) -> tuple[Path, ...]:
    paths = given["bag"] or ()
    if not paths:
        return ()
    if not given["online"]:
        raise SettingsError(
            "--tarl-bag needs --tarl-online, which compares the missions in the bags with the recording."
        )
    for other in ("repair", "drift", "episodes", "log"):
        if given[other]:
            raise SettingsError(
                f"--tarl-bag and --tarl-{other} cannot be used together: a bag cannot be run again. Model "
                "its world as a "
                "drift scenario of the marker, and use that."
            )
    if given["ros"] == "real":
        raise SettingsError("--tarl-bag replays on the embedded ROS: remove --tarl-ros=real.")
    return tuple(dict.fromkeys(Path(path).absolute() for path in paths))


def number_within(
    where: str, name: str, value: Any, kind: type[int] | type[float], low: float, high: float
) -> Any:
    """Return the value if it is a number of type `kind` within the limits. Raise SettingsError otherwise."""
    takes = int if kind is int else (int, float)
    if isinstance(value, bool) or not isinstance(value, takes) or not low <= value <= high:
        within = (
            f"whole number from {low:.0f} to {high:.0f}"
            if kind is int
            else f"number from {low:g} to {high:g}"
        )
        raise SettingsError(f"{where}: {name} must be a {within}, got {value!r}.")
    return kind(value)
