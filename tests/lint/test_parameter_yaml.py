"""The YAML of launch files: the parameters that a node gets, and the message if the YAML cannot be read."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.parameter_yaml import NoYamlError, content, is_wildcard, matches, of_node, sections
from tests.lint.test_system import MANIFEST, RELAY, run, write


def parsed(text: str) -> object:
    return content(Setting("~", Path("a.yaml"), yaml=text))


@pytest.mark.parametrize(
    ("pattern", "node", "holds"),
    [
        ("/**", "/robot/gate", True),
        ("**", "/gate", True),
        ("gate", "/robot/gate", False),
        ("gate", "/gate", True),
        ("/robot/gate", "/robot/gate", True),
        ("/other/gate", "/robot/gate", False),
        ("/*/gate", "/robot/gate", True),
        ("/*/gate", "/gate", False),
        ("/**/gate", "/a/b/gate", True),
        ("/robot/**", "/robot/arm/gate", True),
        ("/*", "/robot/gate", False),
        ("/robot/ga.e", "/robot/gate", False),
    ],
)
def test_section_applies_to_nodes_that_match_its_pattern(pattern, node, holds):
    assert matches(pattern, node) is holds


def test_later_nested_sections_take_precedence():
    text = """
        /**: {ros__parameters: {fastest: 1.0, limits: {top: 3}}}
        robot: {gate: {ros__parameters: {fastest: 2.0}}, other: {ros__parameters: {fastest: 9.0}}}
        empty: {ros__parameters: }
        """
    found = parsed(text)
    assert [name for name, _ in sections(found)] == ["/**", "robot/gate", "robot/other", "empty"]
    assert of_node(found, "/robot/gate") == {"fastest": 2.0, "limits.top": 3}
    assert of_node(parsed("{kp: 1, limits: {top: 3}}"), "/robot/gate") == {"kp": 1, "limits": {"top": 3}}
    assert [is_wildcard(one) for one in ("/**", "/robot/*", "/**/gate")] == [True, True, False]


def test_invalid_yaml_and_a_missing_pyyaml_give_different_messages(monkeypatch):
    with pytest.raises(UnreadableError, match="it is not YAML: "):
        parsed("{kp: ")
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(NoYamlError):
        parsed("{kp: 2}")


@pytest.mark.parametrize(
    ("text", "missing", "said"),
    [
        ("{gain: ", False, "arm/config/a.yaml: it is not YAML: "),
        (
            "{gain: 2}",
            True,
            "arm/config/a.yaml: TARL307 does not check its parameters, since reading them needs",
        ),
        ("{gain: 2}", False, ""),
    ],
)
def test_report_names_parameter_files_unread_by_tarl307(tmp_path, monkeypatch, capsys, text, missing, said):
    body = '<rosparam file="$(find arm)/config/a.yaml"/>'
    launch = f'<launch><node pkg="arm" type="relay.py" name="r">{body}</node></launch>'
    write(
        tmp_path,
        {
            "arm/package.xml": MANIFEST.format("arm", "catkin"),
            "arm/scripts/relay.py": RELAY,
            "arm/config/a.yaml": text,
            "arm/launch/a.launch": launch,
        },
    )
    monkeypatch.chdir(tmp_path)
    if missing:
        monkeypatch.setitem(sys.modules, "yaml", None)
    out = run(capsys, "--launch", "a.launch")[1]
    assert (said in out) if said else ("Not known here" not in out)
    assert ("TARL307 /r has no parameter gain" in out) is (not said)
