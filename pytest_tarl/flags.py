"""The flags that TARL adds to pytest: names and types, which of them start a TARL run, and hints on typos."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, NamedTuple

PREFIX = "--tarl-"


class Flag(NamedTuple):
    """A command line flag; it has a value only if it has a `metavar`."""

    name: str
    help: str
    asks: bool = False  # whether the flag starts a TARL run; other flags configure one
    metavar: str | None = None
    type: type = str
    default: Any = None  # used if neither the command line nor the ini file sets a value
    many: bool = False  # whether the flag may be given several times

    @property
    def key(self) -> str:
        """Return the flag's key in the argument of `options.options`."""
        return self.name.removeprefix(PREFIX)

    @property
    def unset(self) -> Any:
        """Return the value if neither the command line nor the ini file sets one."""
        return False if self.metavar is None else self.default

    def declaration(self) -> dict[str, Any]:
        """Return the keyword arguments for argparse's `add_argument`."""
        if self.metavar is None:
            return {"action": "store_true", "help": self.help}
        if self.many:
            return {"action": "append", "metavar": self.metavar, "help": self.help}
        return {"metavar": self.metavar, "type": self.type, "help": self.help}


FLAGS = (
    Flag("--tarl-record", "record mode: run the episodes and write the reference utility", asks=True),
    Flag(
        "--tarl-online",
        "compare mode: run the drift scenarios and compare them with the recording",
        asks=True,
    ),
    Flag(
        "--tarl-repair",
        "with --tarl-online or --tarl-stress: search for a repair and write a patch",
        asks=True,
    ),
    Flag(
        "--tarl-drift",
        "with --tarl-online: compare only this scenario; with --tarl-record: record under this permanent drift, "
        "which becomes part of the design",
        asks=True,
        metavar="NAME",
    ),
    Flag(
        "--tarl-stress",
        "stress mode: find how far each direction of a drift space may change before the guarantee fails",
        asks=True,
    ),
    Flag(
        "--tarl-stress-budget",
        "limit of --tarl-stress per test: a number of episodes (default 1000), or a time such as 90s or 5min",
        metavar="N",
        default="1000",
    ),
    Flag(
        "--tarl-resume",
        "continue an interrupted run: reuse its finished episodes, and run the others",
        asks=True,
    ),
    Flag("--tarl-seed", "seed of all random numbers (default 0)", metavar="N", type=int, default=0),
    Flag(
        "--tarl-episodes",
        "number of episodes (default: the marker's when recording, 40 when comparing)",
        metavar="N",
        type=int,
    ),
    Flag(
        "--tarl-total",
        (
            "with --tarl-online: total number of episodes of all comparisons in the run; undecided comparisons get "
            "more of them"
        ),
        metavar="N",
        type=int,
    ),
    Flag("--tarl-alpha", "rate of false alarms (default 0.05)", metavar="P", type=float, default=0.05),
    Flag(
        "--tarl-looks",
        (
            "with --tarl-online: how many times a comparison may check its verdict, to end early (default 3; 1 with "
            "--tarl-repair)"
        ),
        metavar="N",
        type=int,
    ),
    Flag(
        "--tarl-search",
        (
            "sweep (default), halving, epsilon-greedy, or module:factory of an optimiser of your own; given twice, "
            "both searches run and the first accepted repair counts"
        ),
        asks=True,
        metavar="METHOD",
        many=True,
    ),
    Flag(
        "--tarl-localize",
        "with --tarl-repair: repair (default) ends when a repair is accepted, full when all sites are ranked",
        asks=True,
        metavar="KIND",
    ),
    Flag(
        "--tarl-budget",
        "limit of a search: a number of episodes (default 300), or a time such as 90s or 5min",
        metavar="N",
        default="300",
    ),
    Flag(
        "--tarl-edit",
        "where an unconditional repair of a named constant is written: auto (default: at its definition, if the "
        "repair holds there), definition, or use",
        metavar="WHERE",
        default="auto",
    ),
    Flag("--tarl-constants", "with --tarl-repair: change constants only, not the structure of the code"),
    Flag(
        "--tarl-utility",
        "batch (default); sarsa, as in the paper; expected-sarsa or td-lambda",
        metavar="KIND",
        default="batch",
    ),
    Flag(
        "--tarl-workers",
        "number of parallel episodes, each in its own process; auto: one per core (default 1)",
        metavar="N",
        default="1",
    ),
    Flag("--tarl-cluster", "run the episodes on the Dask cluster of this scheduler", metavar="ADDRESS"),
    Flag(
        "--tarl-ros",
        "the ROS that nodes run on: embedded (default), real, or auto (real if installed)",
        metavar="KIND",
        default="embedded",
    ),
    Flag(
        "--tarl-log",
        "with --tarl-online: compare the missions in this log of `python -m pytest_tarl observe`",
        asks=True,
        metavar="FILE",
    ),
    Flag(
        "--tarl-holm",
        "with --tarl-online: correct p values and verdicts over all tests of the run (Holm)",
        asks=True,
    ),
    Flag(
        "--tarl-bag",
        "with --tarl-online: replay this recorded mission (.bag, .mcap, .db3, a ROS 2 bag's folder); may be given "
        "several times",
        asks=True,
        metavar="FILE",
        many=True,
    ),
    Flag("--tarl-strict", "with --tarl-online: fail tests without a recording", asks=True),
)


def misspelt(unknown: Iterable[str]) -> str | None:
    """Return a hint on the first unknown argument that resembles a flag of TARL, or None."""
    for word in unknown:
        name = word.partition("=")[0]
        if name.startswith(PREFIX):
            close = get_close_matches(name, [flag.name for flag in FLAGS], 1)
            meant = f": did you mean {close[0]!r}?" if close else "."
            return f"There is no option {name}{meant} Run pytest --help for all options."
    return None
