"""The pytest hooks of TARL: options, marker and fixtures. What a run with TARL's flags does is in session.py."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pytest_tarl.episode import Tarl
    from pytest_tarl.settings import Options

MARKER = (
    "tarl(nodes, sensors, drifts={}, episodes=200, min_success=1.0, tolerance=None, judge=None, monitor=None): "
    "a simulation test that TARL records off-line and compares on-line."
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the flags; those that choose a mode do nothing unless given."""
    group = parser.getgroup("tarl", "TARL: record, compare and repair robot code in simulation")
    flag = group.addoption
    flag(
        "--tarl-record", action="store_true", help="run the episodes off-line and record the utility fixture"
    )
    flag("--tarl-online", action="store_true", help="run the drift scenarios and compare with the fixture")
    flag("--tarl-repair", action="store_true", help="with --tarl-online: search a repair and write a patch")
    flag("--tarl-drift", metavar="NAME", help="with --tarl-online: only this drift scenario")
    flag(
        "--tarl-seed",
        metavar="N",
        type=int,
        default=0,
        help="the one seed that decides everything (default 0)",
    )
    flag(
        "--tarl-episodes",
        metavar="N",
        type=int,
        help="episodes to run instead of the marker's number, or of 40 on-line",
    )
    flag("--tarl-alpha", metavar="P", type=float, default=0.05, help="rate of false alarms (default 0.05)")
    flag(
        "--tarl-looks",
        metavar="N",
        type=int,
        help="with --tarl-online: looks at the verdict, to end early when it is certain (default 3; 1 to repair)",
    )
    flag(
        "--tarl-search",
        metavar="METHOD",
        action="append",
        help="sweep (default) or epsilon-greedy; given twice, both run and the first accepted repair counts",
    )
    flag(
        "--tarl-budget",
        metavar="N",
        default="300",
        help="what a search may spend: episodes (default 300), or a time such as 90s or 5min",
    )
    flag(
        "--tarl-utility",
        metavar="KIND",
        default="batch",
        help="batch (default); sarsa, as in the paper; expected-sarsa or td-lambda",
    )
    flag(
        "--tarl-workers",
        metavar="N",
        default="1",
        help="episodes to run at a time, each in its own process; auto: as many as cores (default 1)",
    )
    flag("--tarl-cluster", metavar="ADDRESS", help="run the episodes on the Dask cluster of this scheduler")
    flag(
        "--tarl-ros",
        metavar="KIND",
        default="embedded",
        help="the ROS that nodes run on: embedded (default), real, or auto (real where it is installed)",
    )
    flag(
        "--tarl-log",
        metavar="FILE",
        help="with --tarl-online: compare the missions in this log of `python -m pytest_tarl observe`",
    )
    flag(
        "--tarl-holm",
        action="store_true",
        help="with --tarl-online: correct p values and verdicts over all tests of the run (Holm)",
    )
    flag(
        "--tarl-bag",
        metavar="FILE",
        action="append",
        help="with --tarl-online: replay this recorded mission (.bag, .mcap, .db3, a ROS 2 bag's folder); may be given "
        "several times",
    )
    flag("--tarl-strict", action="store_true", help="with --tarl-online: a test without fixture fails")


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, and the session object when a mode is asked for."""
    config.addinivalue_line("markers", MARKER)
    if _asked(config):
        from pytest_tarl.session import TarlSession

        config.pluginmanager.register(TarlSession(config, _options(config)), "tarl-session")


@pytest.fixture
def tarl(request: pytest.FixtureRequest) -> Iterator[Tarl]:
    """The episode's random numbers, in-process ROS, sensors and reward."""
    from pytest_tarl.repeating import opened

    with opened(request.node) as episode:
        yield episode


@pytest.fixture
def tarl_drift(request: pytest.FixtureRequest) -> Any:
    """The value of the drift scenario that this episode runs under; None off-line."""
    from pytest_tarl.repeating import drift_value

    return drift_value(request.node)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keep what an episode ended with, and show a user's mistake as a sentence."""
    report = yield
    if call.excinfo is not None and (
        item.get_closest_marker("tarl") is not None or _ours(call.excinfo.value)
    ):
        from pytest_tarl.repeating import keep_error

        keep_error(item, call.excinfo.value, report)
    return report


def _ours(error: BaseException) -> bool:
    return type(error).__module__ == "pytest_tarl.errors"  # told by name: a plain run imports nothing of ours


def _asked(config: pytest.Config) -> bool:
    flags = (
        "--tarl-record",
        "--tarl-online",
        "--tarl-repair",
        "--tarl-drift",
        "--tarl-search",
        "--tarl-strict",
        "--tarl-log",
        "--tarl-bag",
        "--tarl-holm",
    )
    return any(config.getoption(flag) for flag in flags)


def _options(config: pytest.Config) -> Options:
    from pytest_tarl.errors import SettingsError
    from pytest_tarl.settings import options

    try:
        return options(
            {
                name: config.getoption(f"--tarl-{name}")
                for name in (
                    "record",
                    "online",
                    "repair",
                    "drift",
                    "seed",
                    "episodes",
                    "alpha",
                    "looks",
                    "search",
                    "budget",
                    "utility",
                    "workers",
                    "cluster",
                    "strict",
                    "ros",
                    "log",
                    "bag",
                    "holm",
                )
            }
        )
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from None
