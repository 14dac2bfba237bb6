"""Each command forwards its command-line arguments, with the documented defaults, and returns its exit status."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from datetime import date
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest

from pytest_tarl import processors
from pytest_tarl.commands import (
    applying,
    cli,
    diff,
    margins_diff,
    margins_files,
    show,
    summary,
    watch,
    workspace,
)
from pytest_tarl.commands import fleet as fleet_commands
from pytest_tarl.errors import SettingsError
from pytest_tarl.fleet import html as fleet_html
from pytest_tarl.fleet import ingest as ingesting
from pytest_tarl.fleet import json_result, merged, question, words
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.observing import command as observing

Printed = pytest.CaptureFixture[str]


class Calls:
    """Replace functions by stand-ins that note their arguments."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.patch = monkeypatch
        self.made: list[Any] = []

    def replace(self, module: Any, name: str, result: Any = None) -> None:
        def called(*given: Any, **named: Any) -> Any:
            self.made.append((name, *given, named) if named else (name, *given))
            return result

        self.patch.setattr(module, name, called)


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    return Calls(monkeypatch)


def test_the_command_watch_forwards_its_default_values(calls: Calls) -> None:
    calls.replace(watch, "run", 7)
    assert cli.main(["watch", "a.log", "b.log", "--fixture", "x/f.npz"]) == 7
    assert calls.made == [
        ("run", watch.Order((Path("a.log"), Path("b.log")), Path("x/f.npz"), Path(".tarl/watch/f.npz")))
    ]
    order = calls.made[0][1]
    assert (order.alpha, order.seed, order.interval, order.every) == (0.05, 0, 1.0, 60.0)
    assert (order.once, order.until_alarm, order.ros, order.json) == (False, False, "", None)


def test_the_command_watch_forwards_its_arguments(calls: Calls) -> None:
    calls.replace(watch, "run", 0)
    flags = "--state s --json - --alpha 0.1 --seed 3 --interval 2 --every 5 --once --until-alarm --diagnostics rospy"
    cli.main(["watch", "a.log", "--fixture", "f.npz", *flags.split()])
    assert calls.made[0][1] == watch.Order(
        (Path("a.log"),), Path("f.npz"), Path("s"), Path("-"), 0.1, 3, 2.0, 5.0, True, True, "rospy"
    )


def test_observe_forwards_its_defaults_and_prints_a_summary(calls: Calls, capsys: Printed) -> None:
    calls.replace(observing, "observe", "2 missions\x1b")
    assert cli.main(["observe", "node.py"]) == 0
    assert calls.made == [("observe", observing.Order(Path("node.py")))]
    assert capsys.readouterr() == ("", "2 missions\\x1b\n")


def test_the_command_observe_forwards_its_arguments(calls: Calls) -> None:
    calls.replace(observing, "observe", "")
    flags = (
        "--entry main --log m.log --log-size 1.5 --log-keep 4 --fixture f.npz --module a.py --module b.py "
        "--reward-topic /r --step 0.2 --mission-topic /m --idle 3"
    )
    cli.main(["observe", "node.py", *flags.split(), "--", "-x", "1"])
    assert calls.made[0][1] == observing.Order(
        Path("node.py"),
        ("-x", "1"),
        "main",
        Path("m.log"),
        Path("f.npz"),
        (Path("a.py"), Path("b.py")),
        "/r",
        "/m",
        3.0,
        0.2,
        1_500_000,
        4,
    )


@pytest.mark.parametrize("value", ["nan", "inf", "-1", "0"])
@pytest.mark.parametrize("flag", ["--log-size", "--step", "--idle"])
def test_the_command_observe_refuses_numbers_out_of_their_range(
    calls: Calls, capsys: Printed, flag: str, value: str
) -> None:
    calls.replace(observing, "observe", "")
    never = flag == "--log-size" and value == "0"  # the default, which renames no log
    assert cli.main(["observe", "node.py", flag, value]) == (0 if never else 2)
    told = "" if never else f"tarl: {flag} must be a finite number above 0, got {value}.\n"
    assert (capsys.readouterr().err.strip(), len(calls.made)) == (told.strip(), int(never))


def test_the_command_observe_refuses_a_negative_number_of_logs(calls: Calls, capsys: Printed) -> None:
    calls.replace(observing, "observe", "")
    assert cli.main(["observe", "node.py", "--log-keep", "-1"]) == 2
    assert capsys.readouterr().err == "tarl: --log-keep must be a whole number from 0, got -1.\n"
    assert calls.made == []


@pytest.mark.parametrize(
    ("flags", "given"), [([], (False, False)), (["--force"], (True, False)), (["--partial"], (False, True))]
)
def test_the_command_apply_forwards_the_named_patches(
    calls: Calls, capsys: Printed, flags: list[str], given: Any
) -> None:
    calls.replace(applying, "apply", ["applied", "test it"])
    assert cli.main(["apply", "a.patch", "b.patch", *flags]) == 0
    force, partial = given
    assert calls.made == [
        ("apply", [Path("a.patch"), Path("b.patch")], None, {"force": force, "partial": partial})
    ]
    assert capsys.readouterr().out == "applied\ntest it\n"


def test_revert_forwards_the_named_patches(calls: Calls, capsys: Printed) -> None:
    calls.replace(applying, "revert", ["reverted"])
    assert cli.main(["revert", "a.patch", "--directory", "d"]) == 0
    assert calls.made == [("revert", [Path("a.patch")], Path("d"))]
    assert capsys.readouterr().out == "reverted\n"


def test_the_editor_applies_a_patch_with_all_checks(calls: Calls) -> None:
    calls.replace(applying, "apply", iter(["applied"]))
    assert cli._applied(Path("a.patch")) == ["applied"]
    assert calls.made == [("apply", [Path("a.patch")], None, {"force": False, "partial": False})]


@pytest.mark.parametrize("flags", [[], ["--sites"]])
def test_the_command_show_forwards_the_recording_and_the_sizes(
    calls: Calls, capsys: Printed, tmp_path: Path, flags: list[str]
) -> None:
    path = tmp_path / "f.npz"
    path.write_bytes(b"12345")
    recording = SimpleNamespace(lists=(1, 2, 3))
    calls.replace(fixtures, "load", recording)
    calls.replace(fixtures, "sizes", [1, 1, 1])
    calls.replace(show, "lines", ["line"])
    assert cli.main(["show", str(path), *flags]) == 0
    assert calls.made == [
        ("load", path),
        ("sizes", path, 3),
        ("lines", recording, 5, [1, 1, 1], {"every": bool(flags)}),
    ]
    assert capsys.readouterr().out == "line\n"


class Found:
    """Stand-in for a difference of two recordings."""

    changed = True
    asked: tuple[float, float] | None = None

    def worse(self, alpha: float, most: float) -> bool:
        self.asked = (alpha, most)
        return True


@pytest.mark.parametrize(
    ("flags", "asked", "status"),
    [
        ([], None, 0),
        (["--fail-if-worse"], (0.05, 0.0), 1),
        (["--fail-if-worse", "--alpha", "0.2", "--max-loss", "3"], (0.2, 3.0), 1),
        (["--fail-if-worse", "--alpha", "0"], (0.0, 0.0), 1),
        (["--fail-if-changed"], None, 1),
    ],
)
def test_diff_fails_only_if_requested(
    calls: Calls, capsys: Printed, flags: list[str], asked: Any, status: int
) -> None:
    found = Found()
    calls.replace(fixtures, "load")
    calls.replace(diff, "compared", found)
    calls.replace(diff, "lines", ["line"])
    assert cli.main(["diff", "a.npz", "b.npz", *flags]) == status
    assert found.asked == asked
    assert [one[1] for one in calls.made[:2]] == [Path("a.npz"), Path("b.npz")]
    assert capsys.readouterr().out == "line\n"
    found.changed = False
    found.worse = lambda *_: False  # type: ignore[method-assign]
    assert cli.main(["diff", "a.npz", "b.npz", *flags]) == 0


def test_a_recording_is_compared_with_a_second_recording(capsys: Printed) -> None:
    with pytest.raises(SystemExit):
        cli.main(["diff", "a.npz"])
    assert "a second recording to compare with a.npz" in capsys.readouterr().err


ROW = SimpleNamespace(title="test_it[mud]", name="speed", cells=("1 m/s", "2 m/s"), change="more fragile")


@pytest.mark.parametrize(
    ("places", "read"),
    [(["main"], ["main:.tarl/margins", ".tarl/margins"]), (["a.json", "b.json"], ["a.json", "b.json"])],
)
@pytest.mark.parametrize(
    ("change", "flags", "status"),
    [
        ("more fragile", [], 0),
        ("more fragile", ["--fail-if-worse"], 1),
        ("more robust", ["--fail-if-worse"], 0),
        ("more fragile", ["--fail-if-changed"], 0),
    ],
)
def test_margins_are_compared_with_a_revision_or_another_file(
    calls: Calls,
    capsys: Printed,
    places: list[str],
    read: list[str],
    change: str,
    flags: list[str],
    status: int,
) -> None:
    row = SimpleNamespace(**{**vars(ROW), "change": change})
    calls.replace(margins_files, "margins_in", [])
    calls.patch.setattr("pytest_tarl.stressing.margin_changes.compared", lambda *_: [row])
    assert cli.main(["diff", *places, *flags]) == status
    assert [place for _, place in calls.made] == read
    assert capsys.readouterr().out == f"test_it[mud]\n  speed            1 m/s → 2 m/s: {change}\n"


def test_a_comparison_of_margins_can_be_printed_as_markdown(calls: Calls, capsys: Printed) -> None:
    calls.replace(margins_files, "margins_in", [])
    calls.patch.setattr("pytest_tarl.stressing.margin_changes.compared", lambda *_: [ROW])
    assert cli.main(["diff", "main", "--format", "markdown"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "| test | direction | boundary before | boundary now | change |",
        "|---|---|---|---|---|",
        "| `test_it[mud]` | speed | 1 m/s | 2 m/s | ❌ more fragile |",
    ]


def test_rows_of_the_same_test_share_a_heading() -> None:
    rows: Any = [ROW, ROW, SimpleNamespace(**{**vars(ROW), "title": "test_b"}), ROW]
    titles = [line for line in margins_diff.lines(rows) if not line.startswith(" ")]
    assert titles == ["test_it[mud]", "test_b", "test_it[mud]"]
    assert list(margins_diff.table(rows))[2] == "| `test_it[mud]` | speed | 2 m/s |"
    assert margins_diff.plain("a|b`c\n<d>") == "a¦b'c ‹d›"


def test_a_changed_guarantee_is_noted() -> None:
    def one(title: str, success: float, loss: float) -> Any:
        return SimpleNamespace(title=title, success=success, loss=loss)

    before = [one("a", 0.9, 1.0), one("b", 0.9, 1.0), one("c", 0.9, 1.0)]
    after = [one("a", 0.9, 1.0), one("b", 0.95, 1.0), one("c", 0.9, 2.0), one("d", 0.1, 1.0)]
    changes = {"b": "95 % and 1", "c": "90 % and 2"}
    assert list(margins_diff.guarantees_changed(before, after)) == [
        f"{title}: the guarantee changed from a success rate of 90 % and a loss of 1 to {now}, because the test was "
        f"recorded again."
        for title, now in changes.items()
    ]


@pytest.mark.parametrize(
    ("arguments", "given"),
    [([], (Path(".tarl/results"), None)), (["d", "--since", "main"], (Path("d"), "main"))],
)
def test_the_command_summary_forwards_the_folder(
    calls: Calls, capsys: Printed, arguments: list[str], given: Any
) -> None:
    calls.replace(summary, "markdown", "| a |\n")
    assert cli.main(["summary", *arguments]) == 0
    assert calls.made == [("markdown", *given)]
    assert capsys.readouterr().out == "| a |\n"


@pytest.mark.parametrize(("flags", "fixture"), [([], None), (["--fixture", "f.npz"], Path("f.npz"))])
def test_merge_checks_the_path_and_saves(
    calls: Calls, capsys: Printed, flags: list[str], fixture: Any
) -> None:
    calls.replace(fixtures, "prepare")
    calls.replace(merged, "merged", ("recording", "parts"))
    calls.replace(fixtures, "save")
    calls.replace(merged, "lines", ["merged\nforged"])
    assert cli.main(["merge", "a.npz", "b.log", "--to", "c.npz", *flags]) == 0
    assert calls.made == [
        ("prepare", Path("c.npz")),
        ("merged", [Path("a.npz"), Path("b.log")], fixture),
        ("save", "recording", Path("c.npz")),
        ("lines", Path("c.npz"), "recording", "parts"),
    ]
    assert capsys.readouterr().out == "merged\\nforged\n"


def added(log: str, **changed: Any) -> ingesting.Ingested:
    return ingesting.Ingested(Path(log), "r1", **changed)


def ingested(calls: Calls, *found: ingesting.Ingested) -> None:
    calls.replace(ingesting, "ingest", iter(found))


REQUIRED = ["--to", "data", "--fixture", "f.npz", "--robot", "{folder}"]


def test_the_command_ingest_forwards_its_arguments_and_default_values(calls: Calls) -> None:
    ingested(calls)
    cli.main(["ingest", "a.log", *REQUIRED])
    flags = "--version 2 --site roof --repair fix --hash-robots salt"
    cli.main(["ingest", "a.log", "b.log", *REQUIRED, *flags.split()])
    base = ingesting.Order((Path("a.log"),), "data", Path("f.npz"), "{folder}")
    assert calls.made[0][1] == base
    assert calls.made[1][1] == ingesting.Order(
        (Path("a.log"), Path("b.log")), "data", Path("f.npz"), "{folder}", "2", "roof", "salt", "fix"
    )


def test_ingest_prints_missions_per_log_and_in_sum(calls: Calls, capsys: Printed) -> None:
    ingested(
        calls,
        added("a.log", missions=3),
        added("b.log", missions=4, known=2, unjudged=1, notes=("cut off", "late")),
    )
    assert cli.main(["ingest", "a.log", *REQUIRED]) == 0
    told = capsys.readouterr()
    assert told.out.splitlines() == [
        "  a.log: 3 missions of r1",
        "  b.log: 4 missions of r1, 2 were already in the data set, 1 not judged by every formula",
        "    note: cut off",
        "    note: late",
        "data: 7 missions added",
    ]
    assert told.err == ""


def test_refused_log_fails_ingest_at_its_end(calls: Calls, capsys: Printed) -> None:
    ingested(calls, added("a.log", missions=9, problem="a.log: torn"), added("b.log", missions=1))
    assert cli.main(["ingest", "a.log", "b.log", *REQUIRED]) == 2
    assert capsys.readouterr() == (
        "  b.log: 1 missions of r1\ndata: 1 missions added\n",
        "tarl: a.log: torn\n",
    )


class Replays:
    """Stand-in for the processes that replay bags."""

    made: ClassVar[list[Any]] = []
    closed: ClassVar[int] = 0

    def __init__(self, fixture: Any, project: Path) -> None:
        Replays.made.append((fixture, project))

    def close(self) -> None:
        Replays.closed += 1


@pytest.mark.parametrize("fails", [False, True])
def test_bags_are_replayed_through_the_project_of_the_recording(
    calls: Calls, tmp_path: Path, fails: bool
) -> None:
    Replays.made, Replays.closed = [], 0
    calls.patch.setattr("pytest_tarl.workers.replays.Replays", Replays)
    calls.replace(fixtures, "load", "recording")

    def found(order: ingesting.Order) -> Iterator[ingesting.Ingested]:
        assert isinstance(order.replay, Replays)
        if fails:
            raise SettingsError("no")
        return iter([])

    calls.patch.setattr(ingesting, "ingest", found)
    inside = tmp_path / ".tarl" / "utility" / "f.npz"
    for fixture, more, project in (
        (inside, [], tmp_path),
        (tmp_path / "f.npz", [], Path.cwd()),
        (tmp_path / "utility" / "f.npz", [], Path.cwd()),
        (inside, ["--project", str(tmp_path / "p")], tmp_path / "p"),
    ):
        arguments = ["--to", "data", "--fixture", str(fixture), "--robot", "r", *more]
        assert cli.main(["ingest", "a.log", "b.bag", *arguments]) == (2 if fails else 0)
        assert Replays.made.pop() == ("recording", project.resolve())
    assert Replays.closed == 4


class Answer:
    """Stand-in for the answer to a question about a fleet."""

    met: tuple[str, ...] = ()

    def meets(self, rule: str) -> bool:
        return rule in self.met


@pytest.fixture
def answered(calls: Calls) -> Answer:
    found = Answer()
    calls.replace(question, "answer", found)
    calls.replace(json_result, "text", '{"a": "\x1b"}\n')
    calls.replace(words, "lines", ["line\n"])
    calls.replace(fleet_html, "write")
    return found


def asked(calls: Calls) -> question.Question:
    (found,) = (one[1] for one in calls.made if one[0] == "answer")
    calls.made.clear()
    result: question.Question = found
    return result


def test_the_command_fleet_forwards_its_default_values(
    calls: Calls, answered: Answer, capsys: Printed
) -> None:
    assert cli.main(["fleet", "data"]) == 0
    assert asked(calls) == question.Question("data", workers=processors.available())
    assert capsys.readouterr().out == "line\\n\n"


def test_the_command_fleet_forwards_its_arguments(calls: Calls, answered: Answer) -> None:
    flags = (
        "--fixture f.npz --since 2026-10-01 --robot r --alpha 0.1 --tolerance 2 --cluster tcp://c --workers 3"
    )
    cli.main(["fleet", "data", *flags.split(), "--by", " robot, ,week,"])
    assert asked(calls) == question.Question(
        "data", Path("f.npz"), ("robot", "week"), date(2026, 10, 1), "r", 0.1, 2.0, "tcp://c", 3
    )


def test_fleet_writes_its_result_to_the_named_files(
    calls: Calls, answered: Answer, capsys: Printed, tmp_path: Path
) -> None:
    cli.main(["fleet", "data", "--json", "-"])
    assert capsys.readouterr().out == '{"a": "\\x1b"}\n'
    cli.main(["fleet", "data", "--json", str(tmp_path / "a.json"), "--html", "page.html"])
    assert (tmp_path / "a.json").read_text() == '{"a": "\x1b"}\n'
    assert capsys.readouterr().out == "line\\n\n"
    assert [one for one in calls.made if one[0] == "write"] == [("write", answered, Path("page.html"))]


@pytest.mark.parametrize(
    ("met", "flags", "status"),
    [
        (("degraded",), [], 0),
        (("degraded",), ["--fail-if", "degraded"], 1),
        (("robot",), ["--fail-if", "degraded"], 0),
        (("robot",), ["--fail-if", "degraded", "--fail-if", "robot"], 1),
    ],
)
def test_fleet_command_fails_if_fail_if_holds(
    answered: Answer, met: tuple[str, ...], flags: list[str], status: int
) -> None:
    answered.met = met
    assert cli.main(["fleet", "data", *flags]) == status


def test_day_is_given_in_iso_form() -> None:
    assert fleet_commands._day(None) is None
    with pytest.raises(SettingsError, match="--since must be a day such as 2026-10-01, got yesterday"):
        fleet_commands._day("yesterday")


def test_a_result_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(SettingsError, match="cannot be written"):
        fleet_commands._write(tmp_path / "file" / "a.json", "")


@pytest.mark.parametrize(("flags", "out"), [([], "table\n"), (["--format", "json"], "{}\n")])
def test_the_command_workspace_prints_a_table_or_json(
    calls: Calls, capsys: Printed, flags: list[str], out: str
) -> None:
    calls.replace(workspace, "described", "found")
    calls.replace(workspace, "table", ["table"])
    calls.replace(workspace, "document", "{}\n")
    assert cli.main(["workspace", *flags]) == 0
    assert calls.made[0] == ("described", Path())
    assert capsys.readouterr().out == out


def test_each_command_needs_the_packages_of_its_extra(
    monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    needs: Callable[[str], Callable[[str], str]] = lambda extra: lambda what: f"{what} needs {extra}"  # noqa: E731
    for name in ("missing_extra", "missing_fleet", "missing_server"):
        monkeypatch.setattr(cli, name, needs(name))
    given = {
        "missing_extra": [
            ["show", "f"],
            ["diff", "a", "b"],
            ["summary"],
            ["observe", "n"],
            ["watch", "l", "--fixture", "f"],
            ["merge", "a", "--to", "b"],
            ["apply", "p"],
            ["revert", "p"],
            ["suggest", "p"],
        ],
        "missing_fleet": [["ingest", "l", *REQUIRED], ["fleet", "d"]],
        "missing_server": [["lsp"]],
    }
    for extra, commands in given.items():
        for command in commands:
            assert cli.main(command) == 2
            assert capsys.readouterr().err == f"tarl: tarl {command[0]} needs {extra}\n"


def test_a_closed_output_is_not_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> list[str]:
        raise BrokenPipeError

    monkeypatch.setattr(summary, "markdown", broken)
    with (tmp_path / "output").open("w") as output:
        monkeypatch.setattr(sys, "stdout", output)
        assert cli.main(["summary"]) == 0
        print("more", file=output)
    assert not (tmp_path / "output").read_text()


@pytest.mark.parametrize(
    ("given", "argv"),
    [
        (["node.py", "--log", "m.log", "--", "-x", "--", "y"], ["-x", "--", "y"]),
        (["--log", "m.log", "node.py", "--", "--log", "z"], ["--log", "z"]),
        (["node.py", "a", "--log", "m.log", "--", "b"], ["a", "b"]),
        (["node.py", "--log", "m.log", "--"], []),
    ],
)
def test_all_arguments_after_two_dashes_go_to_the_node(given: list[str], argv: list[str]) -> None:
    found = cli.parser().parse_args(["observe", *given])
    assert (found.node, found.log, found.argv) == (Path("node.py"), Path("m.log"), argv)


def test_file_names_with_a_dash_follow_two_dashes() -> None:
    assert cli.parser().parse_args(["show", "--", "-f.npz"]).fixture == Path("-f.npz")
