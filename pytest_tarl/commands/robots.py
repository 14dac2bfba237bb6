"""The commands `tarl observe` and `tarl watch`."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from pytest_tarl.commands.parser import Parser
from pytest_tarl.errors import SettingsError
from pytest_tarl.printable import printable


def add_observe(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl observe`."""
    observe = commands.add_parser(
        "observe", help="run a node on a robot and log its missions for pytest --tarl-online --tarl-log"
    )
    flag = observe.add_argument
    flag("node", type=Path, help="the node's script")
    flag("argv", nargs="*", metavar="-- ARGUMENT", help="arguments of the node, after --")
    flag(
        "--entry", metavar="FUNCTION", help="call this function of the node, like an entry point in setup.py"
    )
    flag(
        "--log",
        type=Path,
        default=Path(".tarl/missions.log"),
        help="log to append to (default .tarl/missions.log)",
    )
    flag(
        "--log-size",
        type=float,
        default=0.0,
        metavar="MB",
        help="rename a longer log to LOG.1, LOG.2, … when a mission begins (default: never)",
    )
    flag(
        "--log-keep",
        type=int,
        default=0,
        metavar="N",
        help="keep only the newest N renamed logs (default: keep all)",
    )
    flag(
        "--fixture",
        type=Path,
        help="the recording whose sensors are observed; found automatically if there is one",
    )
    flag("--module", type=Path, action="append", default=[], help="another file of the node; repeatable")
    flag(
        "--reward-topic",
        default="",
        metavar="TOPIC[:TYPE]",
        help="topic of the monitor's reward (std_msgs/Float64)",
    )
    flag(
        "--step",
        type=float,
        metavar="SECONDS",
        help="length of a step; the marker's judge computes the reward of each step",
    )
    flag(
        "--mission-topic",
        default="",
        metavar="TOPIC[:TYPE]",
        help="topic that carries the words begin, succeeded, failed (std_msgs/String)",
    )
    flag(
        "--idle",
        type=float,
        metavar="SECONDS",
        help="end a mission when the node has published nothing for this time",
    )
    observe.set_defaults(run=_observe)


def _observe(arguments: argparse.Namespace) -> int:
    from pytest_tarl.observing.command import Order, observe

    _check_numbers(arguments)
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
        log_size=round(arguments.log_size * 1e6),
        log_keep=arguments.log_keep,
    )
    print(printable(observe(order)), file=sys.stderr)
    return 0


def _check_numbers(arguments: argparse.Namespace) -> None:
    """Raise SettingsError for a number of `tarl observe` that is out of its range."""
    given = {"--log-size": arguments.log_size or None, "--step": arguments.step, "--idle": arguments.idle}
    for name, value in given.items():
        if value is not None and not 0.0 < value < math.inf:
            raise SettingsError(f"{name} must be a finite number above 0, got {value:g}.")
    if arguments.log_keep < 0:
        raise SettingsError(f"--log-keep must be a whole number from 0, got {arguments.log_keep}.")


def add_watch(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl watch`."""
    watch = commands.add_parser(
        "watch",
        help="judge logged missions as they arrive, and raise an alarm if performance or world change",
    )
    flag = watch.add_argument
    flag("logs", type=Path, nargs="+", metavar="LOG", help="logs of `tarl observe`, which may still grow")
    flag("--fixture", type=Path, required=True, help="the recording to compare the missions with")
    flag("--once", action="store_true", help="read the logs once, print the result and exit")
    flag("--until-alarm", action="store_true", help="exit at the first alarm")
    flag(
        "--alpha",
        metavar="P",
        type=float,
        default=0.05,
        help="probability of ever raising a false alarm (default 0.05)",
    )
    flag(
        "--seed",
        metavar="N",
        type=int,
        default=0,
        help="seed for breaking ties between missions (default 0)",
    )
    flag(
        "--state",
        type=Path,
        metavar="FILE",
        help="file with the state of the watch; continued if it exists (default .tarl/watch/FIXTURE.npz)",
    )
    flag(
        "--json",
        type=Path,
        metavar="FILE",
        help="write the result to this file for other programs; - for standard output",
    )
    flag(
        "--interval",
        metavar="SECONDS",
        type=float,
        default=1.0,
        help="time between reads of the logs (default 1)",
    )
    flag(
        "--every",
        metavar="SECONDS",
        type=float,
        default=60.0,
        help="time between lines of output (default 60)",
    )
    flag("--diagnostics", choices=("rclpy", "rospy"), help="run as a ROS node that publishes on /diagnostics")
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
