"""The parts of a run with TARL's flags: scenarios, selection, shared episodes, reports at the end, other tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import Drift, session
from pytest_tarl.accounts import Compared
from pytest_tarl.learning.sequential import FEWEST
from pytest_tarl.session import PLAIN_WIDTH, UNMARKED, TarlSession, _of_all_tests

SPACE = Drift.space(mud=Drift.range(0.0, 1.0, nominal=1.0))


def options(**given: Any) -> Any:
    usual: dict[str, Any] = {
        "mode": "online",
        "drift": None,
        "holm": False,
        "total": None,
        "log": None,
        "bags": (),
        "most_looks": 3,
        "alpha": 0.05,
        "stress_repair": False,
        "comparisons": 1,
    }
    return SimpleNamespace(**{**usual, **given})


class Terminal:
    """A terminal that keeps what is written."""

    fullwidth = 120

    def __init__(self) -> None:
        self.lines: list[str] = []

    def line(self, text: str, **_: Any) -> None:
        self.lines.append(text)


def config(terminal: Any = None, **given: Any) -> Any:
    usual: dict[str, Any] = {
        "rootpath": Path("/root"),
        "getoption": lambda *_: None,
        "pluginmanager": SimpleNamespace(
            has_plugin=lambda _: terminal is not None, get_plugin=lambda _: None
        ),
        "get_terminal_writer": lambda: terminal,
    }
    return SimpleNamespace(**{**usual, **given})


def run(terminal: Any = None, **given: Any) -> TarlSession:
    return TarlSession(config(terminal), options(**given))


def test_reports_wait_only_with_holm_or_a_total() -> None:
    assert not _of_all_tests(options())
    assert _of_all_tests(options(holm=True))
    assert _of_all_tests(options(total=100))


@pytest.mark.parametrize("given", [{"holm": True}, {"total": 100}])
def test_corrections_over_all_tests_are_refused_with_xdist(given: Any) -> None:
    with pytest.raises(pytest.UsageError, match="over all tests of a run"):
        TarlSession(config(workerinput={}), options(**given))
    with pytest.raises(pytest.UsageError, match="over all tests of a run"):
        TarlSession(config(getoption=lambda *_: 2), options(**given))
    TarlSession(config(), options(**given))
    TarlSession(config(workerinput={}), options())


def scenarios(drifts: Any, takes: bool = True, marked: bool = True, **given: Any) -> Any:
    """Return the scenarios and their ids by which a test is parametrized; None if it is not."""
    marker = SimpleNamespace(kwargs={} if drifts is None else {"drifts": drifts}) if marked else None
    found: list[Any] = []
    metafunc: Any = SimpleNamespace(
        definition=SimpleNamespace(get_closest_marker=lambda _: marker),
        fixturenames=["tarl_drift"] if takes else [],
        parametrize=lambda name, values, ids, indirect: found.append((name, values, ids, indirect)),
    )
    run(**given).pytest_generate_tests(metafunc)
    return found[0][1:3] if found else None


def test_test_runs_once_per_selected_scenario() -> None:
    both = {"mud": 0.5, "world": SPACE}
    assert scenarios(both) == (["mud", "world"], ["mud", "world"])
    assert scenarios(None) == ([None], ["online"])
    assert scenarios({}) == ([None], ["online"])
    assert scenarios(["mud"]) == ([None], ["online"])
    assert scenarios(both, drift="world") == (["world"], ["world"])
    assert scenarios(both, drift="sand") == ([None], ["online"])
    assert scenarios(both, mode="stress") == (["world"], ["world"])
    assert scenarios(both, log="a.csv") == scenarios(both, bags=("a",)) == ([None], ["online"])
    assert scenarios(both, takes=False) is None
    assert scenarios(both, marked=False) is None
    assert scenarios(both, mode="record") is None


class Item:
    """A collected test, with or without the marker."""

    def __init__(self, name: str, marked: bool) -> None:
        self.nodeid, self.marked = name, marked

    def get_closest_marker(self, _: str) -> Any:
        return SimpleNamespace(kwargs={}) if self.marked else None


def item(name: str = "t.py::test", marked: bool = True) -> Any:
    return Item(name, marked)


def collected(of: TarlSession, *items: Any) -> tuple[list[Any], list[Any]]:
    """Return the items that are left, and those that are deselected."""
    gone: list[Any] = []
    found = [*items]
    asked: Any = SimpleNamespace(hook=SimpleNamespace(pytest_deselected=lambda items: gone.extend(items)))
    of.pytest_collection_modifyitems(asked, found)
    return found, gone


def test_unmarked_tests_are_deselected() -> None:
    one, other, plain = item("a"), item("b"), item("c", marked=False)
    of: Any = run(holm=True)
    of.options = SimpleNamespace(drift=None, mode="online", holm=True, total=None)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(
            session,
            "replace",
            lambda given, comparisons: SimpleNamespace(comparisons=comparisons, total=None),
        )
        assert collected(of, one, plain, other) == ([one, other], [plain])
        assert of.options.comparisons == 2
    assert collected(run(), one) == ([one], [])


def warned(of: TarlSession) -> list[str]:
    terminal = Terminal()
    of.config = config(terminal)
    of.pytest_unconfigure()
    return terminal.lines


def test_a_run_without_any_marked_test_gives_a_warning() -> None:
    of = run()
    collected(of, item(marked=False))
    assert warned(of) == [UNMARKED]
    for items in ([], [item(), item(marked=False)]):
        of = run()
        collected(of, *items)
        assert warned(of) == []


def shared(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, total: int, *recorded: bool) -> Any:
    of = run(total=total)
    paths = {f"t{number}": tmp_path / f"{number}.npz" for number in range(len(recorded))}
    for path, exists in zip(paths.values(), recorded, strict=True):
        if exists:
            path.write_bytes(b"")
    monkeypatch.setattr("pytest_tarl.design.fixture_path", lambda _, test: paths[test])
    return of._sharing(total, [item(name) for name in paths])


def test_only_recorded_tests_share_episodes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found = shared(monkeypatch, tmp_path, 100, True, False, True)
    assert (found.total, found.comparisons, found.most_looks) == (100, 2, 3)


def test_a_total_that_is_too_small_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert shared(monkeypatch, tmp_path, 1, False) is None
    with pytest.raises(pytest.UsageError, match="is too small: this run has 2 comparisons"):
        shared(monkeypatch, tmp_path, 2 * FEWEST - 1, True, True)


class Ended:
    """A finished test that notes what is done with it."""

    def __init__(self, outcome: Any, log: list[Any]) -> None:
        self.outcome, self.said, self.item = outcome, log, item(f"item {len(log)}")
        self.told: Any = None

    def proceed(self, run: Any, stage: Any) -> None:
        self.said.append((self.outcome.name, stage))

    def conclude(self, told: Any) -> None:
        self.told = told

    def log(self) -> None:
        self.said.append("logged")


def compared(name: str) -> Compared:
    none: Any = None
    comparison: Any = SimpleNamespace(notes=("old",))
    return Compared(name, Path(), 80, comparison, none, {})


def test_shared_episodes_go_to_undecided_comparisons(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[Any] = []
    of, one, other = run(), compared("one"), compared("other")
    ended: Any = [Ended(one, said), Ended("skipped", said), Ended(other, said)]
    of._ended = ended
    stages = iter([(2, "first"), (0, "second"), (2, "third"), None])
    plan: Any = SimpleNamespace(
        following=lambda outcomes: next(stages), notes=lambda outcomes: ["note 1", "", "note 3"]
    )
    noted: Any = lambda self, note: SimpleNamespace(told=f"{self.name}: {note}")  # noqa: E731
    monkeypatch.setattr(Compared, "noted", noted)
    of._share(plan)
    assert said == [("other", "first"), ("one", "second"), ("other", "third")]
    assert [each.told for each in ended] == ["one: note 1", None, "other: note 3"]


def told(monkeypatch: pytest.MonkeyPatch, **given: Any) -> tuple[list[Any], list[Any], TarlSession]:
    said: list[Any] = []
    of = run(**given)
    ended: Any = [Ended(compared("one"), said), Ended("skipped", said), Ended(compared("other"), said)]
    of._ended = ended
    monkeypatch.setattr(session, "started", lambda _: said.append("started"))
    corrected: Any = lambda found, alpha: [  # noqa: E731
        SimpleNamespace(told=f"{one.name} at {alpha}") for one in found
    ]
    monkeypatch.setattr("pytest_tarl.accounts.jointly", corrected)
    of._tell()
    return said, [one.told for one in ended], of


def test_finished_tests_are_reported_once_and_corrected_together(monkeypatch: pytest.MonkeyPatch) -> None:
    said, concluded, of = told(monkeypatch)
    assert (said, concluded) == (["logged"] * 3, [None] * 3)
    of._tell()
    assert len(said) == 3
    said, concluded, _ = told(monkeypatch, total=100)
    assert (said, concluded) == (["started", "logged"] * 3, [None] * 3)
    said, concluded, _ = told(monkeypatch, holm=True)
    assert (said, concluded) == (["started", "logged"] * 3, ["one at 0.05", None, "other at 0.05"])


def protocol(monkeypatch: pytest.MonkeyPatch, *, interrupted: bool = False, **given: Any) -> list[str]:
    """Run two tests, the second of which is the last; return what pytest was told, and when."""
    said: list[str] = []

    class Function:
        def __init__(self, name: str, marker: str = "tarl") -> None:
            self.name, self.marker = name, marker

        def get_closest_marker(self, name: str) -> str | None:
            return self.marker if name == self.marker else None

    of = run(**given)
    monkeypatch.setattr(pytest, "Function", Function)
    monkeypatch.setattr(session, "started", lambda item: said.append(f"{item.name} started"))
    monkeypatch.setattr(session, "passed", lambda *_: None)
    monkeypatch.setattr(session, "finish", lambda *_: None)
    monkeypatch.setattr(session, "FinishedTest", lambda item, call, *_: item.name)
    monkeypatch.setattr(of, "_run", lambda *_: SimpleNamespace(interrupted=interrupted))
    monkeypatch.setattr(of, "_tell", lambda: said.append(f"told {', '.join(map(str, of._ended))}"))
    first, last, other = Function("a"), Function("b"), Function("c", "other")
    everything: Any = of
    assert everything.pytest_runtest_protocol(other, last) is None
    assert everything.pytest_runtest_protocol(first, last) is True
    assert everything.pytest_runtest_protocol(last, None) is True
    return said


def test_each_test_is_reported_at_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert protocol(monkeypatch) == ["a started", "told a", "b started", "told a, b"]
    for together in ({"holm": True}, {"total": 100}):
        assert protocol(monkeypatch, **together) == ["told a, b"]


def test_an_interrupted_test_ends_the_run_after_its_report(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(KeyboardInterrupt):
        protocol(monkeypatch, interrupted=True)


def test_the_commands_that_apply_patches_are_the_last_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    of = run()
    monkeypatch.setattr(of, "_joined", lambda: SimpleNamespace(commands=("tarl apply a",), lines=()))
    of._summary.patches.append("a.patch")
    assert warned(of) == ["tarl apply a"]
    assert of._summary.patches == []
    assert warned(of) == []


def test_report_is_as_wide_as_the_terminal() -> None:
    assert run(Terminal())._width() == 120
    assert run()._width() == PLAIN_WIDTH
    of = run()
    of._summary.patches.append("a.patch")
    of.pytest_unconfigure()
    assert of._summary.patches == ["a.patch"]


def others(monkeypatch: pytest.MonkeyPatch, **given: Any) -> list[str]:
    class Function:
        def __init__(self, name: str, base: str) -> None:
            self.nodeid, self.base, self.path = name, base, Path(f"/root/{base}.py")

    every: Any = [
        Function("a[mud]", "a"),
        Function("b[mud]", "b"),
        Function("b[wind]", "b"),
        Function("c", "c"),
    ]
    monkeypatch.setattr(session, "without_drift", lambda one: one.base)
    monkeypatch.setattr(session, "designated", lambda one: None if one.base == "c" else "marker")
    monkeypatch.setattr(session, "BesideRollout", lambda *given: given)
    monkeypatch.setattr(pytest, "Function", Function)
    of = run(**given)
    of._designated = tuple(every)
    found: Mapping[str, Any] = {one.test: one for one in of._others(every[0])}
    assert all(one.rollout[0].nodeid == "b[mud]" and one.rollout[3] is every[0] for one in found.values())
    return [*found]


def test_repairs_get_the_other_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    assert others(monkeypatch, mode="repair") == ["b"]
    assert others(monkeypatch, mode="stress", stress_repair=True) == ["b"]
    assert others(monkeypatch, mode="record", drift="mud") == ["b"]
    assert others(monkeypatch, mode="record") == []
    assert others(monkeypatch, mode="online", drift="mud") == []
