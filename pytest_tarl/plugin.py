"""TARL's pytest hooks: options, marker and fixtures. session.py handles runs with TARL's flags."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from pytest_tarl import held_interpreter, ini
from pytest_tarl.errors import SettingsError
from pytest_tarl.extras import missing_extra, missing_packages
from pytest_tarl.flags import FLAGS, PREFIX, Flag, misspelt

if TYPE_CHECKING:
    from pytest_tarl.episode import Tarl
    from pytest_tarl.options import Options

MARKER = (
    "tarl(nodes, sensors, drifts={}, episodes=200, min_success=1.0, confidence=None, total_range=None, tolerance=None, "
    "judge=None, monitor=None, must_hold={}, requires=[], signals=[], reward=None): "
    "a simulation test that TARL records and compares."
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the flags and ini options."""
    group = parser.getgroup("tarl", "TARL: record, compare and repair robot code in simulation")
    for flag in FLAGS:
        group.addoption(flag.name, **flag.declaration())
    ini.declare(parser)


@pytest.hookimpl(wrapper=True)
def pytest_load_initial_conftests(parser: pytest.Parser, args: list[str]) -> Generator[None]:
    """Suggest a flag for a misspelt one, once all plugins and conftest files have declared theirs.

    Raise pytest.UsageError with the suggestion.
    """
    yield
    if any(word.startswith(PREFIX) for word in args):
        sentence = misspelt(parser.parse_known_and_unknown_args(args)[1])
        if sentence is not None:
            raise pytest.UsageError(sentence)


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker and, if a mode is selected, the session object.

    Raise pytest.UsageError if a mode is selected, but the extra `pytest` is not installed.
    """
    config.addinivalue_line("markers", MARKER)
    held_interpreter.prepare()
    if _asked(config):
        sentence = missing_extra("A run with TARL's flags")
        if sentence is not None:
            raise pytest.UsageError(sentence)
        from pytest_tarl.session import TarlSession

        config.pluginmanager.register(TarlSession(config, _options(config)), "tarl-session")


@pytest.fixture
def tarl(request: pytest.FixtureRequest) -> Iterator[Tarl]:
    """Give a test access to its episode: random numbers, ROS, sensors and reward."""
    _require_extra("The fixture `tarl`")
    from pytest_tarl.item_episode import opened

    with opened(request.node) as episode:
        yield episode


@pytest.fixture
def tarl_drift(request: pytest.FixtureRequest) -> Any:
    """Return the drift value of this episode: the scenario's or, without one, the design's; otherwise None."""
    _require_extra("The fixture `tarl_drift`")
    from pytest_tarl.item_episode import drift_value

    return drift_value(request.node)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    """Evaluate an episode's formulas after its body."""
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
    """Store an episode's error, and show user-facing errors without a traceback."""
    report = yield
    if (
        call.excinfo is not None
        and (item.get_closest_marker("tarl") is not None or _ours(call.excinfo.value))
        and not missing_packages()
    ):
        from pytest_tarl.item_episode import add_notes, in_the_node, keep_error

        keep_error(item, call.excinfo.value, report)
        add_notes(item, report)
        if item.config.getoption("usepdb", False):
            call.excinfo = in_the_node(call.excinfo)
        if call.when == "setup" and isinstance(call.excinfo.value, pytest.Collector.CollectError):
            from pytest_tarl.importhint import package_hint

            hint = package_hint(call.excinfo.value)
            if hint:
                report.sections.append(("TARL", hint))
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Show user-facing errors without a traceback; add advice if a test module imports a missing ROS."""
    report = yield
    call: pytest.CallInfo[Any] | None = getattr(report, "call", None)
    if call is not None and call.excinfo is not None and _ours(call.excinfo.value):
        report.longrepr = _at_line(call.excinfo, collector.config.rootpath)
    elif call is not None and call.excinfo is not None and not missing_packages():
        from pytest_tarl.importhint import import_hint

        hint = import_hint(call.excinfo.value)
        if hint:
            report.sections.append(("TARL", hint))
    return report


def _require_extra(what: str) -> None:
    sentence = missing_extra(what)
    if sentence is not None:
        pytest.fail(sentence, pytrace=False)


def _ours(error: BaseException) -> bool:
    return (
        type(error).__module__ == "pytest_tarl.errors"
    )  # compare names: a plain run must not import the module of the class


def _at_line(excinfo: pytest.ExceptionInfo[BaseException], root: Path) -> str:
    """Return a TARL error's text, preceded by file and line of the innermost call in the user's code."""
    ours = Path(__file__).parent
    lines = [entry for entry in excinfo.traceback if ours not in Path(entry.path).parents]
    if not lines:
        return str(excinfo.value)
    path = Path(lines[-1].path)
    shown = path.relative_to(root) if path.is_relative_to(root) else path
    return f"{shown}:{lines[-1].lineno + 1}: {excinfo.value}"


def _asked(config: pytest.Config) -> bool:
    try:
        return ini.mode_asked(config)
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from None


def _options(config: pytest.Config) -> Options:
    from pytest_tarl.options import options

    from_ini: list[Flag] = []
    try:
        given, from_ini = ini.values(config)
        chosen = options(given)
        _look_for_plugged(config, chosen)
    except SettingsError as error:
        named = [ini.ini_name(flag) for flag in from_ini if flag.name in str(error)]
        where = f" ({', '.join(named)} is set in {config.inipath}.)" if named else ""
        raise pytest.UsageError(f"{error}{where}") from None
    return chosen


def _look_for_plugged(config: pytest.Config, options: Options) -> None:
    """Import a user's searches before any episode runs. Raise SettingsError if one cannot be found."""
    named = [name for name in options.searches if ":" in name and options.mode == "repair"]
    if named:
        from pytest_tarl.searching.ask_tell import factory

        for name in named:
            factory(name, (config.invocation_params.dir, config.rootpath))
