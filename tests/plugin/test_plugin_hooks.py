"""The hooks of the plugin, called directly."""

from __future__ import annotations

from collections.abc import Callable, Generator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import ini, plugin
from pytest_tarl.errors import NodeError, SettingsError
from pytest_tarl.plugin import (
    _at_line,
    _look_for_plugged,
    _options,
    _ours,
    pytest_load_initial_conftests,
    pytest_make_collect_report,
    pytest_pyfunc_call,
    pytest_runtest_makereport,
)
from pytest_tarl.repeating import EPISODE, Episode
from pytest_tarl.rollout import EpisodePlan


def sent(hook: Any, outcome: Any) -> Any:
    """Run a wrapper hook around an outcome."""
    next(hook)
    try:
        hook.send(outcome)
    except StopIteration as done:
        return done.value
    raise AssertionError("the hook yielded twice")


def caught(error: BaseException) -> Any:
    try:
        raise error
    except BaseException:
        return pytest.ExceptionInfo.from_current()


def node_error() -> NodeError:
    error = NodeError("Node '/a' raised KeyError.")
    error.__cause__ = caught(KeyError("speed")).value
    return error


def reported(
    error: BaseException | None, marked: bool = True, pdb: bool = False, when: str = "call", stash: Any = None
) -> tuple[Any, Any]:
    """Return the call and the report after the hook."""
    item: Any = SimpleNamespace(
        get_closest_marker=lambda _: "marker" if marked else None,
        config=SimpleNamespace(getoption=lambda *_: pdb),
        path=Path("t.py"),
        stash=stash or {},
    )
    call: Any = SimpleNamespace(excinfo=None if error is None else caught(error), when=when)
    report = SimpleNamespace(failed=True, longrepr="traceback", sections=[])
    return call, sent(pytest_runtest_makereport(item, call), report)


def test_an_error_of_tarl_is_shown_in_one_sentence() -> None:
    assert "tarl.step got" in str(reported(SettingsError("tarl.step got nan"))[1].longrepr)
    assert "tarl.step got" in str(reported(SettingsError("tarl.step got nan"), marked=False)[1].longrepr)
    assert reported(KeyError("speed"))[1].longrepr == "traceback"
    assert reported(None)[1].longrepr == "traceback"


def test_first_error_of_an_episode_is_kept() -> None:
    none: Any = None

    def kept(before: BaseException | None, marked: bool = True) -> Any:
        episode = Episode(EpisodePlan(1), none, error=before)
        reported(KeyError("speed"), marked=marked, stash={EPISODE: episode})
        return episode.error

    assert isinstance(kept(None), KeyError)
    assert isinstance(kept(ValueError("first")), ValueError)
    assert kept(None, marked=False) is None


def test_a_debugger_stops_in_the_code_of_the_node() -> None:
    assert isinstance(reported(node_error())[0].excinfo.value, NodeError)
    assert isinstance(reported(node_error(), pdb=True)[0].excinfo.value, KeyError)
    assert isinstance(reported(NodeError("no cause"), pdb=True)[0].excinfo.value, NodeError)
    assert isinstance(reported(ValueError("no node"), pdb=True)[0].excinfo.value, ValueError)


def test_setup_explains_a_package_that_imports_ros() -> None:
    error = pytest.Collector.CollectError("no")
    error.__cause__ = ModuleNotFoundError("No module named 'rospy'", name="rospy")
    ((title, hint),) = reported(error, when="setup")[1].sections
    assert (title, "__init__.py imports ROS" in hint) == ("TARL", True)
    assert reported(error, when="call")[1].sections == []
    assert reported(pytest.Collector.CollectError("no"), when="setup")[1].sections == []


def collected(error: BaseException | None) -> Any:
    collector: Any = SimpleNamespace(config=SimpleNamespace(rootpath=Path(__file__).parent))
    call = None if error is None else SimpleNamespace(excinfo=caught(error))
    report = SimpleNamespace(longrepr="traceback", sections=[], call=call)
    return sent(pytest_make_collect_report(collector), report)


def test_collection_errors_are_one_sentence_or_come_with_advice() -> None:
    assert collected(None).longrepr == "traceback"
    found = collected(SettingsError("Sensor name 'a b' is wrong."))
    assert found.longrepr.startswith("test_plugin_hooks.py:")
    assert found.longrepr.endswith(": Sensor name 'a b' is wrong.")
    found = collected(ModuleNotFoundError("No module named 'rospy'", name="rospy"))
    assert found.longrepr == "traceback"
    assert found.sections[0][0] == "TARL"
    assert "rospy is not installed" in found.sections[0][1]
    assert collected(ModuleNotFoundError("No module named 'nosuch'", name="nosuch")).sections == []


def test_error_is_located_outside_tarl() -> None:
    def entry(path: Path, line: int) -> Any:
        return SimpleNamespace(path=path, lineno=line)

    def located(*entries: Any) -> str:
        info: Any = SimpleNamespace(traceback=entries, value="wrong")
        return _at_line(info, Path("/root"))

    ours = Path(plugin.__file__).parent / "sensors.py"
    inner = Path(plugin.__file__).parent / "formulas" / "text.py"
    user, far = Path("/root/tests/t.py"), Path("/else/where.py")
    assert located(entry(user, 3), entry(user, 8), entry(ours, 5), entry(inner, 7)) == "tests/t.py:9: wrong"
    assert located(entry(user, 3), entry(far, 0)) == "/else/where.py:1: wrong"
    assert located(entry(ours, 5)) == "wrong"


def test_only_errors_of_tarl_are_recognised_as_such() -> None:
    assert _ours(SettingsError("x"))
    assert not _ours(ValueError("x"))


def concluded(body: Callable[[], Any], marked: bool = True, taken: bool = True) -> tuple[list[Any], Any]:
    """Return what the episode got when the body ended, and the outcome or the error."""
    ends: list[Any] = []
    item: Any = SimpleNamespace(
        funcargs={"tarl": SimpleNamespace(conclude=ends.append)} if taken else {},
        get_closest_marker=lambda _: "marker" if marked else None,
    )
    hook: Generator[None, Any, Any] = pytest_pyfunc_call(item)
    next(hook)
    try:
        outcome = body()
    except Exception as error:
        with pytest.raises(type(error)):
            hook.throw(error)
        return ends, error
    try:
        hook.send(outcome)
    except StopIteration as done:
        return ends, done.value
    raise AssertionError("the hook yielded twice")


def test_episode_is_concluded_once() -> None:
    assert concluded(lambda: "done") == ([None], "done")
    ends, error = concluded(lambda: 1 / 0)
    assert ends == [error]
    assert concluded(lambda: "done", marked=False) == ([], "done")
    assert concluded(lambda: "done", taken=False) == ([], "done")


def test_misspelt_flag_is_suggested_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def loaded(unknown: list[str], *args: str) -> None:
        parser: Any = SimpleNamespace(parse_known_and_unknown_args=lambda _: (None, unknown))
        sent(pytest_load_initial_conftests(parser, [*args]), None)

    loaded([], "--tarl-record")
    loaded(["--tarl-recrod"], "-q")  # none of our flags is given
    with pytest.raises(pytest.UsageError, match="--tarl-record"):
        loaded(["--tarl-recrod"], "--tarl-recrod")


def test_searches_of_the_user_are_imported_before_a_repair(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr("pytest_tarl.searching.ask_tell.factory", lambda *given: asked.append(given))
    config: Any = SimpleNamespace(
        invocation_params=SimpleNamespace(dir=Path("/here")), rootpath=Path("/root")
    )

    def plugged(mode: str, *searches: str) -> list[Any]:
        asked.clear()
        given: Any = SimpleNamespace(searches=searches, mode=mode)
        _look_for_plugged(config, given)
        return [*asked]

    folders = (Path("/here"), Path("/root"))
    assert plugged("repair", "sweep", "mine:Search") == [("mine:Search", folders)]
    assert plugged("online", "mine:Search") == plugged("repair", "sweep") == []


def test_an_invalid_option_of_the_ini_file_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    flags = [SimpleNamespace(name=name) for name in ("--tarl-alpha", "--tarl-seed")]
    config: Any = SimpleNamespace(inipath=Path("/root/pytest.ini"))

    def refused(error: str) -> str:
        def wrong(_: Any) -> None:
            raise SettingsError(error)

        monkeypatch.setattr(ini, "values", lambda _: ({}, flags))
        monkeypatch.setattr("pytest_tarl.options.options", wrong)
        with pytest.raises(pytest.UsageError) as found:
            _options(config)
        return str(found.value)

    assert refused("--tarl-alpha must be below 1.") == (
        "--tarl-alpha must be below 1. (tarl_alpha is set in /root/pytest.ini.)"
    )
    assert refused("--tarl-budget is wrong.") == "--tarl-budget is wrong."
