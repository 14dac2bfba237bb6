"""The command line of `tarl`: fixtures to look at, robots to observe and watch, patches to apply."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path

from pytest_tarl.errors import RefusedError, TarlError
from pytest_tarl.printable import printable, printable_line


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, 1 where it found what it was told to fail on or refused, 2 for what cannot be done."""
    arguments = _parser().parse_args(argv)
    try:
        return int(arguments.run(arguments))
    except RefusedError as refused:
        print(printable(f"tarl: {refused}"), file=sys.stderr)
        return 1
    except TarlError as problem:
        print(printable(f"tarl: {problem}"), file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - what is left to print goes nowhere
        return 0
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130


def _print(lines: Iterable[str]) -> None:
    """Print lines that hold texts of others: code, topics, headers of patches."""
    print("\n".join(map(printable_line, lines)))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="tarl", description="Look at what TARL recorded, apply what it found."
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('tarl')}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    show = commands.add_parser("show", help="tell in a screenful what a fixture holds")
    show.add_argument("fixture", type=Path, help="a file below .tarl/utility or .tarl/online")
    show.add_argument(
        "--sites", action="store_true", help="list the statements of every taint list, however many"
    )
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
    _add_watch(commands)
    _add_patches(commands)
    return parser


def _add_patches(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    apply = commands.add_parser("apply", help="apply patches of repairs, after checking that they still fit")
    apply.add_argument(
        "--force", action="store_true", help="where the file has changed, or has changes to lose"
    )
    apply.add_argument("--partial", action="store_true", help="a partial repair, too, which was not accepted")
    revert = commands.add_parser("revert", help="undo patches of repairs, and nothing else")
    suggest = commands.add_parser(
        "suggest", help="print a patch as suggestions for a review, or as a SARIF fix"
    )
    suggest.add_argument(
        "--format",
        choices=("markdown", "github", "sarif"),
        default="markdown",
        help="suggestion blocks to read and paste (default), a review for GitHub's API, or SARIF 2.1.0",
    )
    for command in (apply, revert):
        command.add_argument("patch", type=Path, nargs="+", help="a file below .tarl/patches")
        command.add_argument(
            "--directory",
            type=Path,
            metavar="DIR",
            help="where the paths of a patch begin; known as long as the patch is below .tarl",
        )
    suggest.add_argument("patch", type=Path, help="a file below .tarl/patches")
    apply.set_defaults(run=_apply)
    revert.set_defaults(run=_revert)
    suggest.set_defaults(run=_suggest)


def _apply(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import applying

    told = applying.apply(
        arguments.patch, arguments.directory, force=arguments.force, partial=arguments.partial
    )
    _print(told)
    return 0


def _revert(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import applying

    _print(applying.revert(arguments.patch, arguments.directory))
    return 0


def _suggest(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.checks import whole
    from pytest_tarl.patching import suggesting
    from pytest_tarl.patching.reading import read

    forms = {"markdown": suggesting.markdown, "github": suggesting.review, "sarif": suggesting.sarif}
    patch = read(arguments.patch)
    whole([patch])
    sys.stdout.write(printable(forms[arguments.format](patch)))
    return 0


def _add_observe(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    observe = commands.add_parser(
        "observe", help="run a node on a robot and log its missions for pytest --tarl-online --tarl-log"
    )
    flag = observe.add_argument
    flag("node", type=Path, help="the node's script")
    flag("argv", nargs="*", metavar="-- ARGUMENT", help="what the node itself is given, after --")
    flag("--entry", metavar="FUNCTION", help="call this function of it, as the entry point in setup.py does")
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
        entry=arguments.entry,
        log=arguments.log,
        fixture=arguments.fixture,
        modules=tuple(arguments.module),
        reward=arguments.reward_topic,
        mission=arguments.mission_topic,
        idle=arguments.idle,
        step=arguments.step,
    )
    print(printable(observe(order)), file=sys.stderr)
    return 0


def _add_watch(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    watch = commands.add_parser(
        "watch",
        help="judge logged missions as they come: is the stated bound kept, is the world as off-line?",
    )
    flag = watch.add_argument
    flag("logs", type=Path, nargs="+", metavar="LOG", help="logs of `tarl observe`, which may still grow")
    flag("--fixture", type=Path, required=True, help="the utility fixture that the missions are held against")
    flag("--once", action="store_true", help="read what is there, tell it and end")
    flag("--until-alarm", action="store_true", help="end with the first alarm")
    flag(
        "--alpha",
        metavar="P",
        type=float,
        default=0.05,
        help="probability of ever a false alarm (default 0.05)",
    )
    flag(
        "--seed",
        metavar="N",
        type=int,
        default=0,
        help="decides how ties between missions are broken (default 0)",
    )
    flag(
        "--state",
        type=Path,
        metavar="FILE",
        help="default .tarl/watch/FIXTURE.npz; goes on from it where it exists",
    )
    flag(
        "--json",
        type=Path,
        metavar="FILE",
        help="keep the account there for other programs; - for standard output",
    )
    flag(
        "--interval",
        metavar="SECONDS",
        type=float,
        default=1.0,
        help="between two looks at the logs (default 1)",
    )
    flag(
        "--every",
        metavar="SECONDS",
        type=float,
        default=60.0,
        help="between two lines of output (default 60)",
    )
    flag("--diagnostics", choices=("rclpy", "rospy"), help="be a ROS node that publishes on /diagnostics")
    watch.set_defaults(run=_watch)


def _watch(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import watch

    order = watch.Order(
        logs=tuple(arguments.logs),
        fixture=arguments.fixture,
        state=arguments.state or watch.default_state(arguments.fixture),
        json=arguments.json,
        alpha=arguments.alpha,
        seed=arguments.seed,
        interval=arguments.interval,
        every=arguments.every,
        once=arguments.once,
        until_alarm=arguments.until_alarm,
        ros=arguments.diagnostics or "",
    )
    return watch.run(order)


def _show(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import show
    from pytest_tarl.learning.fixture import load, sizes

    path: Path = arguments.fixture
    fixture = load(path)
    own = sizes(path, len(fixture.lists))
    _print(show.lines(fixture, path.stat().st_size, own, every=arguments.sites))
    return 0


def _diff(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import diff
    from pytest_tarl.learning.fixture import load

    first, second = load(arguments.first), load(arguments.second)
    found = diff.compared(first, second)
    _print(diff.lines(first, second, found))
    alpha = diff.SIGNIFICANT if arguments.alpha is None else arguments.alpha
    worse = arguments.fail_if_worse and found.worse(alpha, arguments.max_loss)
    return int(worse or (arguments.fail_if_changed and found.changed))
