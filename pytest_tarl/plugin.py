"""The pytest hooks of TARL: options, marker and fixtures. What a run with TARL's flags does is in session.py."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import TYPE_CHECKING, Any

import pytest

from pytest_tarl import holding
from pytest_tarl.flags import FLAGS

if TYPE_CHECKING:
    from pytest_tarl.episode import Tarl
    from pytest_tarl.options import Options

MARKER = (
    "tarl(nodes, sensors, drifts={}, episodes=200, min_success=1.0, confidence=None, total_range=None, tolerance=None, "
    "judge=None, monitor=None, requires=[], signals=[], reward=None): "
    "a simulation test that TARL records off-line and compares on-line."
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the flags; those that choose a mode do nothing unless given."""
    group = parser.getgroup("tarl", "TARL: record, compare and repair robot code in simulation")
    for flag in FLAGS:
        group.addoption(flag.name, **flag.declaration())


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, and the session object when a mode is asked for."""
    config.addinivalue_line("markers", MARKER)
    holding.prepare()
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
    """The value of the drift scenario that this episode runs under; off-line None, or a change that is the design."""
    from pytest_tarl.repeating import drift_value

    return drift_value(request.node)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    """Judge the formulas of an episode when its body is over."""
    episode: Any = pyfuncitem.funcargs.get("tarl")
    if episode is None or pyfuncitem.get_closest_marker("tarl") is None:
        return (yield)
    try:
        outcome = yield
    except BaseException as ended:
        episode.conclude(ended)
        raise
    episode.conclude(None)
    return outcome


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keep what an episode ended with, and show a user's mistake as a sentence."""
    report = yield
    if call.excinfo is not None and (
        item.get_closest_marker("tarl") is not None or _ours(call.excinfo.value)
    ):
        from pytest_tarl.repeating import in_the_node, keep_error

        keep_error(item, call.excinfo.value, report)
        if item.config.getoption("usepdb", False):
            call.excinfo = in_the_node(call.excinfo)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Add advice to the error of a test module that imports a ROS that is not installed."""
    report = yield
    call: pytest.CallInfo[Any] | None = getattr(report, "call", None)
    if call is not None and call.excinfo is not None:
        from pytest_tarl.importhint import import_hint

        hint = import_hint(call.excinfo.value)
        if hint:
            report.sections.append(("TARL", hint))
    return report


def _ours(error: BaseException) -> bool:
    return type(error).__module__ == "pytest_tarl.errors"  # told by name: a plain run imports nothing of ours


def _asked(config: pytest.Config) -> bool:
    return any(config.getoption(flag.name) for flag in FLAGS if flag.asks)


def _options(config: pytest.Config) -> Options:
    from pytest_tarl.errors import SettingsError
    from pytest_tarl.options import options

    try:
        chosen = options({flag.key: config.getoption(flag.name) for flag in FLAGS})
        _look_for_plugged(config, chosen)
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from None
    return chosen


def _look_for_plugged(config: pytest.Config, options: Options) -> None:
    """Look for searches of the user's own now, not after all the episodes of a comparison. Raises SettingsError."""
    named = [name for name in options.searches if ":" in name and options.mode == "repair"]
    if named:
        from pytest_tarl.searching.asking import factory

        for name in named:
            factory(name, (config.invocation_params.dir, config.rootpath))
