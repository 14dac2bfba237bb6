"""What the user asked of a run: its options, checked. Frozen, without pytest."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pytest_tarl.errors import SettingsError

Mode = Literal["plain", "record", "online", "repair"]
SEARCHES = ("sweep", "halving", "epsilon-greedy")
EDITS = ("auto", "use", "definition")
RANKINGS = ("repair", "full")
UTILITIES = ("batch", "sarsa", "expected-sarsa", "td-lambda")
ROS_KINDS = ("embedded", "real", "auto")
MOST_EPISODES = 10**6  # that a search may spend


@dataclass(frozen=True)
class Options:
    """The options of one run of pytest."""

    mode: Mode = "plain"
    seed: int = 0
    drift: str | None = None
    episodes: int | None = None  # overrides the marker off-line, the default on-line
    alpha: float = 0.05
    searches: tuple[str, ...] = ("sweep",)
    localize: str = "repair"  # what ends the search: an accepted repair, or the ranking of all sites
    budget: int = 300  # episodes that a search may spend
    seconds: float | None = None  # that a search may take instead
    edit: str = "auto"  # where a repair of a named constant without a condition is written
    structure: bool = True  # whether changes of structure are tried where no constant suffices
    strict: bool = False
    utility: str = "batch"
    workers: int = 1  # episodes at a time, each in a process of its own when more than one
    cluster: str | None = None  # address of a Dask scheduler
    ros: str = "embedded"
    looks: int | None = None  # at the verdict, at most
    log: Path | None = None  # missions of a robot, instead of on-line episodes
    holm: bool = False  # whether verdicts are corrected over all tests of the run
    comparisons: int = 1  # how many those are
    bags: tuple[Path, ...] = ()  # recorded missions, likewise

    ONLINE_EPISODES = 40
    LOOKS = 3

    @property
    def most_looks(self) -> int:
        """Return how often the verdict may be looked at.

        Once before a repair, which needs the region whole, and before a correction, which asks for smaller p-values
        than those at which a run may end early.
        """
        return self.looks or (1 if self.mode == "repair" or self.holm else self.LOOKS)

    @property
    def learner(self) -> str:
        """Return the rule that learns event by event, when one is asked for; empty for the batch solution."""
        return "" if self.utility == "batch" else self.utility

    @property
    def flags(self) -> tuple[str, ...]:
        """Return the options that shape a comparison and are not the default ones, as they are typed."""
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
    """Check the flags of a run. Raises SettingsError with a sentence."""
    _check_modes(given)
    searches = tuple(dict.fromkeys(given["search"] or ("sweep",)))
    for name in searches:
        if not re.fullmatch(
            r"[\w.]+:\w+", name
        ):  # an optimiser of the user's own is looked for by the session
            _known("--tarl-search", name, (*SEARCHES, "module:factory"))
    localize = given["localize"] or "repair"
    _known("--tarl-localize", localize, RANKINGS)
    if given["localize"] and not given["repair"]:
        raise SettingsError(
            "--tarl-localize goes with --tarl-repair: sites are ranked by what a search finds."
        )
    _known("--tarl-utility", given["utility"], UTILITIES)
    _known("--tarl-edit", given["edit"], EDITS)
    _known("--tarl-ros", given["ros"], ROS_KINDS)
    if given["episodes"] is not None:
        number_within("--tarl-episodes", "it", given["episodes"], int, 2, 10**6)
    if given["looks"] is not None:
        number_within("--tarl-looks", "it", given["looks"], int, 1, 5)
    budget = _budget(str(given["budget"]))
    mode: Mode = "record" if given["record"] else "repair" if given["repair"] else "online"
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
    )


def _check_modes(given: Mapping[str, Any]) -> None:
    """Raise SettingsError where flags do not go together."""
    if not (given["record"] or given["online"] or given["repair"]):
        stray = next(
            (name for name in ("drift", "search", "localize", "strict", "log", "bag", "holm") if given[name]),
            "drift",
        )
        also = ", or with --tarl-record for a drift that is for good" if stray == "drift" else ""
        raise SettingsError(f"--tarl-{stray} goes with --tarl-online{also}, and does nothing without it.")
    if given["record"] and given["online"]:
        raise SettingsError("--tarl-record and --tarl-online are two runs: record first, then compare.")
    if given["repair"] and not given["online"]:
        raise SettingsError("--tarl-repair goes with --tarl-online: it repairs what the comparison finds.")
    if given["holm"] and not given["online"]:
        raise SettingsError("--tarl-holm goes with --tarl-online: it corrects the verdicts of its tests.")
    if given["holm"] and given["repair"]:
        raise SettingsError(
            "--tarl-holm and --tarl-repair are two runs: a verdict is corrected when all tests have run, a repair is "
            "searched for while its test runs. Compare with --tarl-holm first, then repair the tests that are degraded."
        )


def _budget(text: str) -> tuple[int, float | None]:
    """Return how many episodes, or else how many seconds, a search may take: `300`, `90s`, `5min`, `1h`."""
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(s|min|h)?", text.strip())
    unit = found[2] if found else None
    if found is None or float(found[1]) <= 0 or (unit is None and not found[1].isdecimal()):
        raise SettingsError(
            f"--tarl-budget: it must be a number of episodes such as 300, or a time such as 90s or 5min, got {text!r}."
        )
    if unit is None:
        return int(number_within("--tarl-budget", "it", int(found[1]), int, 1, MOST_EPISODES)), None
    return MOST_EPISODES, float(found[1]) * {"s": 1, "min": 60, "h": 3600}[unit]


def _workers(text: str) -> int:
    """Return how many episodes are run at a time; `auto` shares the cores with the workers of pytest-xdist."""
    if text != "auto":
        return int(
            number_within("--tarl-workers", "it", int(text) if text.isdecimal() else text, int, 1, 1024)
        )
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    beside = os.environ.get("PYTEST_XDIST_WORKER_COUNT", "")
    return max(1, cores // (int(beside) if beside.isdecimal() and int(beside) else 1))


def _known(flag: str, name: str, among: Sequence[str]) -> None:
    if name not in among:
        close = difflib.get_close_matches(name, among, 1)
        hint = f"did you mean {close[0]!r}?" if close else f"it takes {' or '.join(among)}."
        raise SettingsError(f"{flag} does not know {name!r}; {hint}")


def _log(given: Mapping[str, Any]) -> Path | None:
    if given["log"] is None:
        return None
    if not given["online"]:
        raise SettingsError("--tarl-log goes with --tarl-online: its missions are the on-line side.")
    for other in ("repair", "drift", "episodes"):
        if given[other]:
            raise SettingsError(
                f"--tarl-log and --tarl-{other} exclude each other: a log holds what happened, and nothing can be run "
                "again in it. Model what it shows as a drift scenario of the marker, and repair that."
            )
    return Path(given["log"]).absolute()


def _typed(path: Path) -> str:
    """Return a path as it is typed in the working directory."""
    return str(path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path)


def _bags(given: Mapping[str, Any]) -> tuple[Path, ...]:
    paths = given["bag"] or ()
    if not paths:
        return ()
    if not given["online"]:
        raise SettingsError("--tarl-bag goes with --tarl-online: its missions are the on-line side.")
    for other in ("repair", "drift", "episodes", "log"):
        if given[other]:
            raise SettingsError(
                f"--tarl-bag and --tarl-{other} exclude each other: a bag holds what happened, and nothing can be run "
                "again in it. Model what it shows as a drift scenario of the marker, and repair that."
            )
    if given["ros"] == "real":
        raise SettingsError("--tarl-bag replays on the embedded ROS: leave --tarl-ros=real out.")
    return tuple(dict.fromkeys(Path(path).absolute() for path in paths))


def number_within(
    where: str, name: str, value: Any, kind: type[int] | type[float], low: float, high: float
) -> Any:
    """Return a number of that kind if it lies within the bounds. Raises SettingsError."""
    takes = int if kind is int else (int, float)
    if isinstance(value, bool) or not isinstance(value, takes) or not low <= value <= high:
        what = "a whole number" if kind is int else "a number"
        raise SettingsError(f"{where}: {name} must be {what} from {low:g} to {high:g}, got {value!r}.")
    return kind(value)
