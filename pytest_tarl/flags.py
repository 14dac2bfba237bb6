"""The flags that pytest gets from TARL: their names, how they are read, and which of them ask for a run of ours."""

from __future__ import annotations

from typing import Any, NamedTuple


class Flag(NamedTuple):
    """One flag of the command line; one without `metavar` is a switch."""

    name: str
    help: str
    asks: bool = False  # whether it asks for a run of ours; the others say how such a run goes
    metavar: str | None = None
    type: type = str
    default: Any = None
    many: bool = False  # whether it may be given several times

    @property
    def key(self) -> str:
        """Name it as `options.options` does."""
        return self.name.removeprefix("--tarl-")

    def declaration(self) -> dict[str, Any]:
        """Return what argparse is told."""
        if self.metavar is None:
            return {"action": "store_true", "help": self.help}
        if self.many:
            return {"action": "append", "metavar": self.metavar, "help": self.help}
        return {"metavar": self.metavar, "type": self.type, "default": self.default, "help": self.help}


FLAGS = (
    Flag("--tarl-record", "run the episodes off-line and record the utility fixture", asks=True),
    Flag("--tarl-online", "run the drift scenarios and compare with the fixture", asks=True),
    Flag("--tarl-repair", "with --tarl-online: search a repair and write a patch", asks=True),
    Flag(
        "--tarl-drift",
        "with --tarl-online: only this drift scenario; with --tarl-record: make one that is for good the design",
        asks=True,
        metavar="NAME",
    ),
    Flag("--tarl-seed", "the one seed that decides everything (default 0)", metavar="N", type=int, default=0),
    Flag(
        "--tarl-episodes",
        "episodes to run instead of the marker's number, or of 40 on-line",
        metavar="N",
        type=int,
    ),
    Flag("--tarl-alpha", "rate of false alarms (default 0.05)", metavar="P", type=float, default=0.05),
    Flag(
        "--tarl-looks",
        "with --tarl-online: looks at the verdict, to end early when it is certain (default 3; 1 to repair)",
        metavar="N",
        type=int,
    ),
    Flag(
        "--tarl-search",
        "sweep (default), halving, epsilon-greedy, or module:factory of an optimiser of your own; given twice, both "
        "run and the first accepted repair counts",
        asks=True,
        metavar="METHOD",
        many=True,
    ),
    Flag(
        "--tarl-localize",
        "with --tarl-repair: repair (default) ends when a repair is accepted, full goes on until all sites are ranked",
        asks=True,
        metavar="KIND",
    ),
    Flag(
        "--tarl-budget",
        "what a search may spend: episodes (default 300), or a time such as 90s or 5min",
        metavar="N",
        default="300",
    ),
    Flag(
        "--tarl-edit",
        "where an unconditional repair of a named constant is written: auto (default; where it is defined, if that "
        "holds, too), definition, or use",
        metavar="WHERE",
        default="auto",
    ),
    Flag("--tarl-constants", "with --tarl-repair: change constants only, never the structure of the code"),
    Flag(
        "--tarl-utility",
        "batch (default); sarsa, as in the paper; expected-sarsa or td-lambda",
        metavar="KIND",
        default="batch",
    ),
    Flag(
        "--tarl-workers",
        "episodes to run at a time, each in its own process; auto: as many as cores (default 1)",
        metavar="N",
        default="1",
    ),
    Flag("--tarl-cluster", "run the episodes on the Dask cluster of this scheduler", metavar="ADDRESS"),
    Flag(
        "--tarl-ros",
        "the ROS that nodes run on: embedded (default), real, or auto (real where it is installed)",
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
    Flag("--tarl-strict", "with --tarl-online: a test without fixture fails", asks=True),
)
