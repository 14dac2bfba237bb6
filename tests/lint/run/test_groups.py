"""A run analyses its programs one by one, reuses reports, and states which findings are final so far."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint import editing
from tarl_lint.baseline import load
from tarl_lint.editing import Workspace
from tarl_lint.errors import LintError
from tarl_lint.model import Cut
from tarl_lint.read.source import Module, Script, SourceError
from tarl_lint.run import groups
from tarl_lint.run.cache import Cache, Report
from tarl_lint.run.groups import Task, examine, failure, perform
from tarl_lint.settings.config import Config

NODE = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("{0}", Float64, queue_size=1)
rospy.Subscriber("in", Float64, lambda msg: out.publish(msg.data))
rospy.spin()
"""


def scripts(*sizes: int) -> list[Script]:
    """Return nodes a.py, b.py, ... with so many further lines."""
    return [
        Script(f"{name}.py", name, NODE.format(name) + "\n" * size)
        for name, size in zip("abcdefgh", sizes, strict=False)
    ]


class Memory(Cache):
    """A cache in memory that knows which files were edited."""

    def __init__(self, *edited: str) -> None:
        super().__init__(None)
        self.kept: dict[str, Report] = {}
        self.plans: dict[str, list[str]] = {}
        self.names = frozenset(edited)
        self.saved = 0

    def report(self, key):
        return self.kept.get(key)

    def put(self, key, report):
        self.kept[key] = report

    def edited(self, digests):
        return self.names

    def plan(self, key):
        return self.plans.get(key, [])

    def put_plan(self, key, keys):
        self.plans[key] = [*keys]

    def save(self):
        self.saved += 1


@pytest.fixture
def performed(monkeypatch) -> list[str]:
    """Return the files that were analysed, in order."""
    names: list[str] = []
    real = groups.perform

    def record(task, *given):
        names.append(task.scripts[-1].path)
        return real(task, *given)

    monkeypatch.setattr(groups, "perform", record)
    return names


def test_programs_are_analysed_once_and_their_reports_are_reused(performed):
    cache, told = Memory(), []
    found = examine(scripts(0, 0), Config(), cache, tell=told.append)
    assert [one.flow.sink.topics for one in found.findings if one.flow] == [("a",), ("b",)]
    assert (performed, cache.saved) == (["a.py", "b.py"], 1)
    assert told == ["Analysing a.py (1 of 2)", "Analysing b.py (2 of 2)"]
    assert examine(scripts(0, 0), Config(), cache) == found
    assert len(performed) == 2, "the plan names all reports"
    cache.plans.clear()
    assert examine(scripts(0, 1), Config(), cache) == found
    assert performed[2:] == ["b.py"]


def test_edited_programs_come_first_and_then_small_ones(performed):
    examine(scripts(30, 10, 20, 40), Config(), Memory("d.py"), partly=lambda *_: None)
    assert performed == ["d.py", "b.py", "c.py", "a.py"]


def test_programs_keep_their_order_without_partial_results(performed):
    examine(scripts(30, 10, 20), Config(), Memory("c.py"))
    assert performed == ["a.py", "b.py", "c.py"]


def test_final_findings_come_after_one_two_and_four_programs(performed):
    told: list[tuple[int, list[str]]] = []
    examine(
        scripts(*range(7)),
        Config(),
        Memory(),
        partly=lambda report, settled: told.append((len(report.findings), sorted(settled))),
    )
    assert told == [
        (1, ["a.py"]),
        (2, ["a.py", "b.py"]),
        (4, ["a.py", "b.py", "c.py", "d.py"]),
    ]
    assert len(performed) == 7


def test_findings_are_final_after_all_importing_programs():
    shared = Script("shared.py", "shared", "x = 1\n")
    tasks = [Task((shared, one), analyse=True) for one in scripts(0, 0)]
    told: list[frozenset[str]] = []
    progress = groups._Progressive(lambda _, settled: told.append(settled), frozenset())
    progress.tell(tasks, [Report(), None], 1)
    progress.tell(tasks, [Report(), None], 3)
    progress.tell(tasks, [Report(), Report()], 2)
    assert told == [frozenset({"a.py"})]


def test_files_without_endpoints_are_only_parsed(performed):
    plain = Script("x.py", "x", "x = 1\n")
    broken = Script("y.py", "y", "x = (\n")
    installed = Script("z.py", "z", "x = (\n", installed=True)
    found = examine([plain, broken, installed, *scripts(0)], Config(), Memory())
    assert performed == ["a.py", "x.py", "y.py"]
    assert [one.path for one in found.errors] == ["y.py"]
    assert Task((plain,), analyse=False).lines == 0
    assert Task((plain, broken), analyse=True).lines == 2


def test_a_file_of_several_programs_is_parsed_once(monkeypatch):
    parsed: list[str] = []
    real = groups.parsed
    monkeypatch.setattr(groups, "parsed", lambda script: parsed.append(script.path) or real(script))
    one, two = scripts(0, 0)
    tasks = [Task((one,), analyse=False), Task((one, two), analyse=False), Task((one,), analyse=False)]
    shared = groups._Parsed(tasks)
    modules = [shared.module(script) for task in tasks for script in task.scripts]
    assert parsed == ["a.py", "b.py"]
    assert modules[0] is modules[1] is modules[3]
    assert shared._known == {}, "a file that no further program has is dropped"


def test_reports_of_programs_are_joined_without_repetitions():
    error, other = SourceError("b.py", 2, "x"), SourceError("a.py", 3, "y")
    one = Report((), (error, other), (Cut("b.py"),), ("m.B", "m.A"))
    assert groups._joined([one, Report((), (error,), (Cut("a.py"),), ("m.A",))]) == Report(
        (), (other, error), (Cut("a.py"), Cut("b.py")), ("m.A", "m.B")
    )


def test_crash_is_reported_as_a_bug(monkeypatch):
    def crash(_: Script) -> Module:
        raise KeyError("x")

    monkeypatch.setattr(groups, "parsed", crash)
    monkeypatch.delenv("TARL_DEBUG", raising=False)
    task = Task(tuple(scripts(0)), analyse=False)
    (error,) = perform(task, Config()).errors
    assert error.bug
    assert error.message.startswith(
        "tarl-lint failed on this file (KeyError: 'x'), which is a bug in tarl-lint."
    )
    assert failure("a.py", ValueError()).message.startswith("tarl-lint failed on this file (ValueError), ")
    assert failure("a.py", RecursionError("x")) == SourceError(
        "a.py", 1, "The code is nested too deeply to be analysed: split the expression, or exclude the file."
    )
    for value, raised in (("0", False), ("", False), ("1", True)):
        monkeypatch.setenv("TARL_DEBUG", value)
        assert groups.debugging() is raised
    with pytest.raises(KeyError):
        perform(task, Config())


def test_an_accepted_finding_joins_the_baseline(in_directory, tmp_path):
    in_directory({"a.py": NODE.format("x") + "out.publish(1.0)\n", "b.py": NODE.format("y")})
    workspace = Workspace([Path()])
    result = workspace.lint({})
    first, second = (one.fingerprint.digest() for one in result.found)
    path = workspace.accept(first, result)
    assert path.resolve() == tmp_path / "tarl-flows.json"
    assert [one.fingerprint.digest() for one in load(path).entries] == [first]
    assert {one.status for one in workspace.lint({}).findings} == {"new", "accepted"}
    workspace.accept(second, result)
    workspace.accept(first, result)
    assert sorted(one.fingerprint.digest() for one in load(path).entries) == sorted([first, second])
    assert workspace.lint({}).new == ()
    path.write_text("{")
    with pytest.raises(LintError):
        workspace.accept(first, result)


def test_reports_are_kept_for_ten_unused_runs():
    memory = editing._Memory(Config(), Cache(None))
    memory.put("a", Report(ended=("x",)))
    for _ in range(editing.KEPT_RUNS):
        memory.save()
    assert memory._known == {"a": Report(ended=("x",))}
    assert memory.report("a") == Report(ended=("x",))
    for _ in range(editing.KEPT_RUNS):
        memory.save()
    assert "a" in memory._known, "each use counts"
    memory.save()
    assert (memory._known, memory.report("a"), memory.plan("a")) == ({}, None, [])


def test_edited_files_differ_from_the_last_complete_run():
    memory = editing._Memory(Config(), Cache(None))
    assert memory.edited({"a.py": "1"}) == frozenset()
    memory.save()
    assert memory.edited({"a.py": "1", "b.py": "2"}) == {"b.py"}
    assert memory.edited({"a.py": "3"}) == {"a.py"}
    memory.save()
    assert memory.edited({"a.py": "3"}) == frozenset()
