"""The parameters of a node: from values, from YAML, and from the sections that match the node."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.launch_parameters import ON_ROBOT, leaves, stated
from tarl_lint.workspace.name_resolution import joined, remapped, resolved
from tarl_lint.workspace.parameter_yaml import content, dotted, is_wildcard, matches, of_node, sections

HERE = Path("a.yaml")


def values(*settings: Setting, node: str = "/n") -> dict[str, Any]:
    return {one.name: one.value for one in stated(settings, node)}


def test_each_yaml_entry_gets_the_name_of_its_setting():
    assert values(Setting("~a", HERE, 1), Setting("/b", HERE, "x"), Setting("~c", HERE, yaml="[1, 2]")) == {
        "~a": 1, "/b": "x", "~c": [1, 2],
    }  # fmt: skip
    assert values(Setting("~", HERE, yaml="a: 1\nb: {c: 2}")) == {"~a": 1, "~b": {"c": 2}}
    assert values(Setting("/robot/", HERE, yaml="a: 1")) == {"/robot/a": 1}
    assert values(Setting("/", HERE, yaml="a: 1")) == {"/a": 1}
    assert values(Setting("~in", HERE, yaml="a: 1")) == {"~in/a": 1}


def test_values_that_only_the_robot_knows_are_marked():
    yaml = Setting("~c", HERE, yaml="d: $(arg e)\nf: 1")
    assert values(Setting("~a", HERE, unknown=True), Setting("~b", HERE, "$(env B)"), yaml) == {
        "~a": ON_ROBOT, "~b": ON_ROBOT, "~c/d": ON_ROBOT, "~c/f": 1,
    }  # fmt: skip


def test_nested_values_have_names_with_slashes():
    assert dict(leaves({"a": {"b": {"c": 1}, "d": {}}, "e": [2]})) == {"a/b/c": 1, "a/d": {}, "e": [2]}
    endless: dict[str, Any] = {}
    endless["a"] = endless
    ((name, value),) = leaves(endless)
    assert (name.count("/"), value) == (50, endless)


@pytest.mark.parametrize(
    ("pattern", "node", "found"),
    [
        ("gate", "/gate", True),
        ("/gate", "/gate", True),
        ("gate", "/ns/gate", False),
        ("/ns/gate", "/ns/gate", True),
        ("/*/gate", "/ns/gate", True),
        ("/*/gate", "/gate", False),
        ("/*/gate", "/a/b/gate", False),
        ("/**/gate", "/gate", True),
        ("/**/gate", "/a/b/gate", True),
        ("/**", "/a/b/gate", True),
        ("*", "/gate", True),
        ("*", "/ns/gate", False),
        ("/ns/**", "/ns/a/b", True),
        ("/ns/**", "/other/a", False),
        ("g.te", "/gate", False),
    ],
)
def test_section_is_for_matching_nodes(pattern, node, found):
    assert matches(pattern, node) is found


def test_sections_are_found_at_any_depth():
    file = {
        "/**": {"ros__parameters": {"a": 1}},
        "ns": {"gate": {"ros__parameters": {"b": 2}}, "x": 3},
        "/deep/": {"gate": {"ros__parameters": None}},
        "plain": {"c": 4},
    }
    assert list(sections(file)) == [("/**", {"a": 1}), ("ns/gate", {"b": 2}), ("/deep/gate", {})]
    assert list(sections([1])) == list(sections({"a": 1})) == []
    assert [is_wildcard(one) for one in ("/**", "*", "/ns/*", "gate", "/**/gate")] == [
        True,
        True,
        True,
        False,
        False,
    ]


def test_later_parameter_sections_take_precedence():
    file = {
        "/**": {"ros__parameters": {"a": 1, "b": {"c": 2}}},
        "gate": {"ros__parameters": {"a": 5}},
        "other": {"ros__parameters": {"a": 6}},
    }
    assert of_node(file, "/gate") == {"a": 5, "b.c": 2}
    assert of_node(file, "/ns/gate") == {"a": 1, "b.c": 2}
    assert of_node({"gate": file["gate"]}, "/") == {"a": 5}, "a node without a name"
    assert of_node({"a": {"b": 1}}, "/gate") == {"a": {"b": 1}}, "a file without sections is for every node"
    assert dotted({"a": {"b": {"c": 1}}, "d": {}}) == {"a.b.c": 1}


def test_yaml_that_cannot_be_read_is_refused():
    assert content(Setting("~", HERE, 1)) is None
    assert content(Setting("~", HERE, yaml="a: [1]")) == {"a": [1]}
    with pytest.raises(UnreadableError, match="it is not YAML: "):
        content(Setting("~", HERE, yaml="a: ["))
    bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "\n".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 7)
    )
    with pytest.raises(UnreadableError, match="it has too many values"):
        content(Setting("~", HERE, yaml=bomb))


@pytest.mark.parametrize(
    ("namespace", "name", "whole"),
    [("/", "a", "/a"), ("/n", "a", "/n/a"), ("/n/", "a//b/", "/n/a/b"), ("/n", "/a", "/a"), ("", "a", "/a"),
     ("/n", "", "/n")],
)  # fmt: skip
def test_a_name_is_joined_to_its_namespace(namespace, name, whole):
    assert joined(namespace, name) == whole


def test_names_of_a_node_are_resolved_and_remapped():
    assert resolved("~a", "/n", "m") == resolved("~/a", "/n", "m") == "/n/m/a"
    assert resolved("a", "/n", "m") == "/n/a"
    remaps = (("a", "b"), ("/x", "~y"), ("~z", "/w"), ("a", "c"))
    assert [remapped(one, "/n", "m", remaps) for one in ("a", "/n/a", "/x", "~z", "d")] == [
        "/n/c", "/n/c", "/n/m/y", "/w", "/n/d",
    ]  # fmt: skip
