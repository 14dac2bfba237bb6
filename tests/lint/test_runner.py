import sys
import types
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import tarl_lint
from tarl_lint import baseline
from tarl_lint.errors import AnalysisBug, UsageError
from tarl_lint.run import groups
from tarl_lint.run.runner import Result, exceeds, run
from tarl_lint.settings.config import Options, resolve


@pytest.fixture
def lint() -> Callable[..., Result]:
    def go(*paths: str, **options) -> Result:
        chosen = Options(paths=tuple(map(Path, paths)) or (Path(),), **options)
        return run(chosen, resolve(chosen))

    return go


@pytest.fixture
def accept(lint) -> Callable[..., Path]:
    """Accept all findings, as --write-baseline does, and return the baseline."""

    def go(*paths: str) -> Path:
        result = lint(*paths, write_baseline=True)
        baseline.save(Path("tarl-flows.json"), baseline.merged(result.found, result.kept))
        return Path("tarl-flows.json")

    return go


@pytest.fixture
def crash(monkeypatch):
    def examine(modules, config, isolate, readings):
        raise KeyError("graph")

    broken = types.ModuleType("tarl_lint.engine")
    broken.examine = examine
    monkeypatch.setitem(sys.modules, "tarl_lint.engine", broken)
    monkeypatch.setattr(tarl_lint, "engine", broken, raising=False)


def test_flows_are_found_with_fingerprint_and_text(example, in_directory, lint):
    in_directory({"node.py": example.text})
    result = lint()
    assert [f.code for f in result.findings] == ["TARL101"]
    assert len(result.findings[0].fingerprint) == 16
    assert result.texts == {"node.py": example.text}
    assert (result.statistics.files, result.statistics.lines) == (1, example.text.count("\n"))


def test_unparsable_file_is_an_error_and_the_rest_is_linted(example, in_directory, lint):
    in_directory({"node.py": example.text, "broken.py": "def f(:\n", "old.py": "print 'x'\n"})
    result = lint()
    assert [(e.path, e.line) for e in result.errors] == [("broken.py", 1), ("old.py", 1)]
    assert len(result.findings) == 1
    assert result.statistics.files == 1


def test_parser_crash_is_an_error(example, in_directory, lint, monkeypatch):
    def parsed(script):
        if script.path == "odd.py":
            raise AssertionError("boom")
        return original(script)

    original = groups.parsed
    monkeypatch.setattr(groups, "parsed", parsed)
    in_directory({"node.py": example.text, "odd.py": ""})
    result = lint()
    (message,) = (error.message for error in result.errors)
    assert message.startswith(
        "tarl-lint failed on this file (AssertionError: boom), which is a bug in tarl-lint. Please report"
    )
    assert len(result.findings) == 1


def test_a_file_that_disappears_meanwhile_is_an_error(example, in_directory, lint, monkeypatch):
    in_directory({"node.py": example.text, "gone.py": ""})
    opened = Path.open
    monkeypatch.setattr(
        Path,
        "open",
        lambda p, *how, **more: opened(p.parent / "no" if p.name == "gone.py" else p, *how, **more),
    )
    result = lint()
    assert [(e.path, e.message) for e in result.errors] == [
        ("gone.py", "This file cannot be read: No such file or directory. Make it readable, or exclude it.")
    ]


def test_analysis_crash_is_reported_in_one_sentence(example, in_directory, lint, crash, monkeypatch):
    in_directory({"node.py": example.text})
    with pytest.raises(
        AnalysisBug, match=r"has a bug .*KeyError: 'graph', test_runner\.py:\d+\).*TARL_DEBUG=1"
    ):
        lint()
    monkeypatch.setenv("TARL_DEBUG", "1")
    with pytest.raises(KeyError):
        lint()


def test_a_run_without_python_files_lists_what_was_found(in_directory, lint):
    in_directory({"README": "", "node.cpp": "ros::init(argc, argv);"})
    with pytest.raises(UsageError, match=r"no Python file to lint in \. \(there are 1 C\+\+ nodes"):
        lint()


def test_rules_that_are_ignored_report_nothing(example, in_directory, lint):
    in_directory({"node.py": example.text})
    assert lint(ignore=("TARL1",)).findings == ()
    assert lint(select=("TARL102",)).findings == ()


def test_results_of_sanitizers_are_not_tainted(example, in_directory, lint):
    text = example.text.replace("import rospy\n", "import rospy\nfrom safety import fixed\n", 1)
    root = in_directory({"node.py": text.replace("pub.publish(vel)", "pub.publish(fixed(vel))")})
    assert [f.code for f in lint().findings] == ["TARL101"]
    (root / "pyproject.toml").write_text('[tool.tarl-lint]\nsanitizers = ["safety.fixed"]\n')
    assert "TARL101" not in [f.code for f in lint().findings]


def test_silenced_flow_is_counted_and_useless_comment_reported(example, in_directory, lint):
    text = example.text.replace("pub.publish(vel)", "pub.publish(vel)  # tarl: ignore[TARL101]")
    in_directory({"node.py": text, "clean.py": "x = 1  # tarl: ignore\n"})
    result = lint()
    assert result.findings == ()
    assert [f.code for f in result.silenced] == ["TARL101"]
    assert [(s.path, s.line) for s in result.unused] == [("clean.py", 1)]


def test_comment_for_a_rule_that_did_not_run_is_accepted(example, in_directory, lint):
    in_directory({"node.py": example.text.replace("(vel)", "(vel)  # tarl: ignore[TARL101]", 1)})
    assert lint(select=("TARL102",)).unused == ()


def test_accepted_flows_stay_accepted_when_lines_move(example, in_directory, lint, accept):
    root = in_directory({"node.py": example.text})
    accept()
    (root / "node.py").write_text("#!/usr/bin/env python3\n\n\n" + example.text)
    result = lint()
    assert [f.status for f in result.findings] == ["accepted"]
    assert result.new == ()
    assert result.vanished == ()


def test_flow_added_to_an_accepted_fingerprint_makes_all_new(example, in_directory, lint, accept):
    root = in_directory({"node.py": example.text})
    accept()
    twice = example.text.replace(
        "        pub.publish(vel)\n", "        pub.publish(vel)\n        pub.publish(vel)\n"
    )
    (root / "node.py").write_text(twice)
    assert [f.status for f in lint().findings] == ["new", "new"]


def test_a_missing_flow_is_reported_as_vanished(example, in_directory, lint, accept):
    root = in_directory({"node.py": example.text})
    accept()
    (root / "node.py").write_text("x = 1\n")
    assert [e.fingerprint.source for e in lint().vanished] == ["odom"]
    (root / "node.py").rename(root / "renamed.py")
    assert [e.fingerprint.source for e in lint().vanished] == ["odom"]


def test_accepted_flows_of_unreadable_files_stay_in_the_baseline(example, in_directory, lint, accept):
    root = in_directory({"a/node.py": example.text, "b/other.py": "x = 1\n"})
    path = accept()
    before = path.read_bytes()
    assert lint("b", baseline=path).vanished == ()
    (root / "a/node.py").write_text("def f(:\n")
    result = lint(baseline=path)
    assert result.vanished == ()
    assert len(result.kept) == 1
    accept()
    assert path.read_bytes() == before


def test_flows_of_rules_that_did_not_run_are_kept(example, in_directory, lint, accept):
    in_directory({"node.py": example.text})
    path = accept()
    result = lint(baseline=path, select=("TARL102",))
    assert (len(result.vanished), len(result.kept)) == (0, 1)


def test_a_baseline_is_the_same_from_every_directory(example, in_directory, lint, accept, monkeypatch):
    root = in_directory({"pyproject.toml": "[tool.tarl-lint]\n", "src/node.py": example.text})
    before = accept().read_bytes()
    monkeypatch.chdir(root / "src")
    result = lint()
    assert [f.status for f in result.findings] == ["accepted"]
    assert baseline.dumps(baseline.merged(result.found, result.kept)).encode() == before


def test_equal_nodes_of_two_ros_packages_are_distinguished(example, in_directory, lint):
    manifest = "<package><name>{}</name></package>"
    in_directory(
        {"a/package.xml": manifest.format("left"), "a/scripts/node.py": example.text,
         "b/package.xml": manifest.format("right"), "b/scripts/node.py": example.text}
    )  # fmt: skip
    assert [e.fingerprint.package for e in lint().found] == ["left", "right"]


@pytest.mark.parametrize(
    ("level", "codes", "fails"),
    [
        ("never", ("TARL201", "TARL101", "TARL102"), False),
        ("hazard", ("TARL101", "TARL102"), False),
        ("hazard", ("TARL201",), True),
        ("explicit", ("TARL102",), False),
        ("explicit", ("TARL101",), True),
        ("explicit", ("TARL201",), True),
        ("implicit", ("TARL102",), True),
        ("implicit", ("TARL101",), True),
        ("implicit", (), False),
    ],
)
def test_each_fail_on_level_includes_the_lower_ones(example, in_directory, level, codes, fails):
    in_directory({})
    result = Result(findings=tuple(replace(example.finding(), code=code) for code in codes))
    assert exceeds(result, resolve(Options(fail_on=level))) is fails
    accepted = Result(findings=tuple(replace(f, status="accepted") for f in result.findings))
    assert not exceeds(accepted, resolve(Options(fail_on=level)))
