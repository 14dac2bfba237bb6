"""Each setting and option accepts the values that its message describes, and no others."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import pytest

from tarl_lint import options
from tarl_lint.errors import UsageError
from tarl_lint.settings.schema import KEYS, Wrapper, check_pattern

ACCEPTED: list[tuple[str, Any, Any]] = [
    ("select", ["tarl1", "TARL2"], ("TARL1", "TARL2")),
    ("select", [], ()),
    ("extend-select", ["TARL103"], ("TARL103",)),
    ("exclude", ["a/", "*.py"], ("a/", "*.py")),
    ("exclude", [r"a\ b"], (r"a\ b",)),
    ("baseline", "a.json", "a.json"),
    ("per-file-ignores", {"a/": ["tarl1"], "b": ["TARL2", "TARL3"]}, (("a/", ("TARL1",)), ("b", ("TARL2", "TARL3")))),
    ("per-file-ignores", {}, ()),
    ("sources", ["a.b", "a.b.c"], ("a.b", "a.b.c")),
    ("sinks", [], ()),
    ("sanitizers", ["a.b"], ("a.b",)),
    ("wrappers", {"a.b": "rospy.Subscriber"}, (Wrapper("a.b", "rospy.Subscriber"),)),
    ("wrappers", {"a.b": {"like": "x", "topic": 0, "type": "kind"}}, (Wrapper("a.b", "x", 0, "kind"),)),
    ("wrappers", {"a.b": {"like": "x", "callback": 2, "extra": 3}}, (Wrapper("a.b", "x", callback=2, extra=3),)),
    ("follow-installed", ["a", "b_c"], ("a", "b_c")),
    ("python", ".venv", ".venv"),
    ("remaps", {"a": "b"}, (("a", "b"),)),
    ("remaps", {}, ()),
    ("tf2", True, True),
    ("tf2", False, False),
    *(("fail-on", value, value) for value in ("never", "hazard", "explicit", "implicit")),
]  # fmt: skip
REFUSED: list[tuple[str, Any]] = [
    *((key, value) for key in ("select", "exclude", "sources", "follow-installed")
      for value in ("a", [1], [""], {"a": 1}, None)),
    *(("baseline", value) for value in ("", 1, ["a"], None)),
    *(("per-file-ignores", value) for value in (["a"], {"a": "TARL1"}, {"a": []}, {"a": ["TARL1"], "b": [1]})),
    *(("sources", [name]) for name in ("a", "a.", ".a", "a.1", "a b.c", "a..b")),
    *(("follow-installed", [name]) for name in ("a.b", "1a", "-x")),
    *(("wrappers", {"a.b": spec}) for spec in ({}, {"topic": 0}, {"like": 1}, 1, {"like": "x", "topic": -1},
      {"like": "x", "topic": True}, {"like": "x", "topic": "a b"}, {"like": "x", "topic": None})),
    ("wrappers", {"a": "rospy.Subscriber"}),
    ("wrappers", {"a.b": "x", "c": "x"}),
    ("wrappers", ["a.b"]),
    *(("remaps", value) for value in (["a"], {"a": ""}, {"": "a"}, {"a": 1})),
    *(("tf2", value) for value in (1, 0, "true", None)),
    *(("fail-on", value) for value in ("always", "", None, True)),
]  # fmt: skip


@pytest.mark.parametrize(("key", "value", "found"), ACCEPTED)
def test_a_setting_accepts_valid_values(key, value, found):
    assert KEYS[key][0](value) == found


@pytest.mark.parametrize(("key", "value"), REFUSED)
def test_a_setting_refuses_invalid_values(key, value):
    assert KEYS[key][0](value) is None


def test_unknown_wrapper_key_is_refused_by_name():
    with pytest.raises(
        ValueError, match=r"the wrapper 'a.b' has no key 'topics': its keys are callback, extra, like, "
    ):
        KEYS["wrappers"][0]({"a.b": {"like": "x", "topics": 1}})


@pytest.mark.parametrize(("pattern", "meant"), [("a\\b", "a/b"), ("a\\b\\", "a/b/"), ("\\", "/")])
def test_a_pattern_with_backslashes_is_refused(pattern, meant):
    with pytest.raises(ValueError, match=f"write it with slashes, as in .gitignore: '{meant}'"):
        check_pattern(pattern)
    with pytest.raises(ValueError, match="has backslashes"):
        KEYS["per-file-ignores"][0]({pattern: ["TARL1"]})


@pytest.mark.parametrize(("text", "number"), [("auto", None), ("1", 1), ("12", 12)])
def test_number_of_processes_is_positive_or_auto(text, number):
    assert options._jobs(text) == number


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "many", ""])
def test_an_invalid_number_of_processes_is_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match="write 1 or more, or auto"):
        options._jobs(text)


def test_a_number_of_flows_is_zero_or_more():
    assert [options._number(text) for text in ("0", "7")] == [0, 7]
    for text in ("-1", "x", "", "1.0"):
        with pytest.raises(argparse.ArgumentTypeError, match="write 0 or more"):
            options._number(text)


def parsed(*arguments: str) -> Any:
    return options.options(options.parser().parse_args(arguments))


def test_defaults_lint_the_working_directory():
    found = parsed()
    assert (found.paths, found.stdin, found.cache, found.jobs, found.fail_on) == (
        (Path(),),
        None,
        True,
        None,
        None,
    )
    assert (found.select, found.ignore, found.exclude, found.per_file_ignores) == (None, None, None, None)
    assert (found.extend_select, found.extend_exclude, found.no_baseline, found.write_baseline) == (
        (),
        (),
        False,
        False,
    )


def test_command_line_options_are_parsed_into_fields():
    found = parsed("a", "b.py", "--select", "TARL1,TARL2", "--ignore", "TARL102", "--no-cache", "--jobs", "3",
                   "--fail-on", "implicit", "--per-file-ignores", "t/:TARL1", "--exclude", "x",
                   "--extend-exclude", "y,z",
                   "--baseline", "b.json", "--write-baseline")  # fmt: skip
    assert found.paths == (Path("a"), Path("b.py"))
    assert (found.select, found.ignore) == (("TARL1", "TARL2"), ("TARL102",))
    assert (found.cache, found.jobs, found.fail_on) == (False, 3, "implicit")
    assert found.per_file_ignores == (("t/", ("TARL1",)),)
    assert (found.exclude, found.extend_exclude) == (("x",), ("y", "z"))
    assert (found.baseline, found.write_baseline) == (Path("b.json"), True)
    assert parsed("--exit-zero", "--fail-on", "hazard").fail_on == "never"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--no-baseline", "--write-baseline"), "--no-baseline and --write-baseline cannot be used together"),
        (("--no-baseline", "--baseline", "a"), "--no-baseline and --baseline cannot be used together"),
        (("--stdin-filename", "a.py"), "--stdin-filename needs text on standard input: add - to the paths."),
    ],
)
def test_contradictory_options_are_refused(arguments, message):
    with pytest.raises(UsageError, match=message):
        parsed(*arguments)


def test_a_closed_standard_input_is_refused(monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(UsageError, match="Standard input is closed"):
        parsed("-")
