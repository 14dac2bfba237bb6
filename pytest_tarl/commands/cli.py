"""The command line of `tarl`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from pytest_tarl.errors import TarlError


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, 1 where `diff` found what it was told to fail on, 2 for what cannot be done."""
    arguments = _parser().parse_args(argv)
    try:
        return int(arguments.run(arguments))
    except TarlError as problem:
        print(f"tarl: {problem}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - what is left to print goes nowhere
        return 0
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="tarl", description="Look at what TARL recorded.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    show = commands.add_parser("show", help="tell in a screenful what a fixture holds")
    show.add_argument("fixture", type=Path, help="a file below .tarl/utility or .tarl/online")
    show.set_defaults(run=_show)
    diff = commands.add_parser("diff", help="compare two fixtures")
    diff.add_argument("first", type=Path)
    diff.add_argument("second", type=Path)
    diff.add_argument(
        "--fail-if-worse",
        action="store_true",
        help="exit with 1 when the second one earns significantly less",
    )
    diff.add_argument(
        "--max-loss",
        metavar="R",
        type=float,
        default=0.0,
        help="with --fail-if-worse: a loss of reward per episode that nobody minds (default 0)",
    )
    diff.add_argument(
        "--alpha", metavar="P", type=float, help="with --fail-if-worse: rate of false alarms (default 0.05)"
    )
    diff.add_argument(
        "--fail-if-changed",
        action="store_true",
        help="exit with 1 when a recorded statement was edited or the sensors are others",
    )
    diff.set_defaults(run=_diff)
    _add_observe(commands)
    return parser


def _add_observe(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    observe = commands.add_parser(
        "observe", help="run a node on a robot and log its missions for pytest --tarl-online --tarl-log"
    )
    flag = observe.add_argument
    flag("node", type=Path, help="the node's script")
    flag("argv", nargs="*", metavar="-- ARGUMENT", help="what the node itself is given, after --")
    flag(
        "--log", type=Path, default=Path(".tarl/missions.log"), help="default .tarl/missions.log; appended to"
    )
    flag(
        "--fixture", type=Path, help="the utility fixture whose sensors are watched; found where there is one"
    )
    flag("--module", type=Path, action="append", default=[], help="a further file of the node; repeatable")
    flag("--reward-topic", default="", metavar="TOPIC[:TYPE]", help="the monitor's reward (std_msgs/Float64)")
    flag(
        "--step", type=float, metavar="SECONDS", help="close a step this often; the marker's judge rewards it"
    )
    flag(
        "--mission-topic",
        default="",
        metavar="TOPIC[:TYPE]",
        help="begin, succeeded, failed (std_msgs/String)",
    )
    flag(
        "--idle", type=float, metavar="SECONDS", help="a mission ends when nothing was published for so long"
    )
    observe.set_defaults(run=_observe)


def _observe(arguments: argparse.Namespace) -> int:
    from pytest_tarl.observing.command import Order, observe

    order = Order(
        node=arguments.node,
        argv=tuple(arguments.argv),
        log=arguments.log,
        fixture=arguments.fixture,
        modules=tuple(arguments.module),
        reward=arguments.reward_topic,
        mission=arguments.mission_topic,
        idle=arguments.idle,
        step=arguments.step,
    )
    print(observe(order), file=sys.stderr)
    return 0


def _show(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import show
    from pytest_tarl.learning.fixture import load, sizes

    path: Path = arguments.fixture
    fixture = load(path)
    print("\n".join(show.lines(fixture, path.stat().st_size, sizes(path, len(fixture.lists)))))
    return 0


def _diff(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import diff
    from pytest_tarl.learning.fixture import load

    first, second = load(arguments.first), load(arguments.second)
    found = diff.compared(first, second)
    print("\n".join(diff.lines(first, second, found)))
    alpha = diff.SIGNIFICANT if arguments.alpha is None else arguments.alpha
    worse = arguments.fail_if_worse and found.worse(alpha, arguments.max_loss)
    return int(worse or (arguments.fail_if_changed and found.changed))
