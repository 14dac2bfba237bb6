"""Substitutions of launch files, CMake words and setup files, without a workspace."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.workspace.cmake import cmake, commands
from tarl_lint.workspace.executables import has_shebang, is_python, module_file
from tarl_lint.workspace.launch_entities import substitutions
from tarl_lint.workspace.launch_values import (
    Anonymous,
    Choice,
    Comparison,
    Configuration,
    Expression,
    Here,
    Joined,
    Logic,
    OnRobot,
    Package,
)
from tarl_lint.workspace.parameter_yaml import of_node
from tarl_lint.workspace.setup_files import Setup, setup
from tarl_lint.workspace.substitutions import SymbolicError, scalar


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("plain", "plain"),
        ("$(open", "$(open"),
        ("$(var a)", Configuration("a")),
        ("$(var a b)", Configuration("a", "b")),
        ("$(var 'a b')", Configuration("a b")),
        ("$(var 'open)", Configuration("'open")),
        ("$(var $(var x))", Configuration(Configuration("x"))),
        ("a$(var x)b", Joined(("a", Configuration("x"), "b"))),
        ("$(find-pkg-share p)/x", Joined((Package("p"), "/x"))),
        ("$(dirname)", Here(whole=False)),
        ("$(filename)", Here(whole=True)),
        ("$(anon n)", Anonymous("n")),
        ("$(env A)", OnRobot("env A", None)),
        ("$(env A d)", OnRobot("env A d", "d")),
        ("$(optenv A)", OnRobot("optenv A", "")),
        ("$(equals a b)", Comparison("a", "b", equal=True)),
        ("$(not-equals a b)", Comparison("a", "b", equal=False)),
        ("$(equals a)", OnRobot("equals a")),
        ("$(not true)", Logic("not", ("true",))),
        ("$(and a b)", Logic("and", ("a", "b"))),
        ("$(if true a b)", Choice("true", "a", "b")),
        ("$(if true a)", Choice("true", "a", "")),
        ("$(if true)", OnRobot("if true")),
        ("$(eval 1 + 2)", Expression(("1 + 2",))),
        ("$(eval '1 + $(var n)')", Expression((Joined(("1 + ", Configuration("n"))),))),
        ("$(eval ')", Expression(("'",))),
        ("$(unknown x)", OnRobot("unknown x")),
        ("$()", OnRobot("")),
    ],
)
def test_each_substitution_is_evaluated(text, meaning):
    assert substitutions(text) == meaning


CMAKE = """
    project(arm)  # a comment (with parentheses)
    set(NODES scripts/a.py scripts/b.py)
    set(WHERE "lib/${PROJECT_NAME}")
    catkin_install_python(PROGRAMS ${NODES} "scripts/c.py" DESTINATION ${WHERE})
    install(PROGRAMS scripts/d.py DESTINATION lib/${PROJECT_NAME} RENAME d)
    ament_python_install_package(${PROJECT_NAME} PACKAGE_DIR src/arm)
    ament_python_install_package(other)
    ament_python_install_package(last PACKAGE_DIR)
    if(UNKNOWN AND (A OR B))
    endif()
"""


def test_words_of_cmake_have_their_variables_replaced(tmp_path):
    found = [(command.name, command.words) for command in commands(dedent(CMAKE), tmp_path, "arm")]
    assert found[3] == (
        "catkin_install_python",
        ("PROGRAMS", "scripts/a.py", "scripts/b.py", "scripts/c.py", "DESTINATION", "lib/arm"),
    )
    assert found[-2] == ("if", ("UNKNOWN", "AND", "A", "OR", "B"))


def test_installed_programs_and_packages_of_cmake_are_found(tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(dedent(CMAKE))
    built = cmake(tmp_path, "arm")
    assert dict(built.python_packages) == {"arm": "src/arm", "other": "other", "last": "last"}
    assert {file for file, _ in built.programs} == {f"scripts/{name}.py" for name in "abcd"}
    assert dict(built.programs)["scripts/d.py"] == "d"
    assert not built.uses_setup
    (tmp_path / "CMakeLists.txt").write_text("catkin_python_setup()")
    assert cmake(tmp_path, "arm").uses_setup
    assert cmake(tmp_path / "nowhere", "arm").programs == ()


CFG = """
    [options]
    packages = find:
    py_modules =
        tool
        other
    scripts = bin/run
    package_dir =
        = src
    [options.packages.find]
    where = src
    [options.entry_points]
    console_scripts =
        node = arm.node:main
"""


def test_the_declarations_of_setup_cfg_are_read(tmp_path):
    (tmp_path / "setup.py").write_text("from setuptools import setup\nsetup()\n")
    (tmp_path / "setup.cfg").write_text(dedent(CFG))
    declared = setup(tmp_path)
    assert declared.packages is None
    assert (declared.modules, declared.scripts) == (("tool", "other"), ("bin/run",))
    assert dict(declared.folders) == {"": "src"}
    assert declared.console == (("node", "arm.node", "main"),)
    assert declared.problems == ()


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ("packages=names()", "`packages` is not constant"),
        ("py_modules=names()", "`py_modules` is not constant"),
        ("scripts=['a', names()]", "a part of `scripts` is not constant"),
    ],
)
def test_computed_values_in_setup_py_are_reported(tmp_path, given, problem):
    (tmp_path / "setup.py").write_text(f"from setuptools import setup\nsetup(\n    {given},\n)\n")
    assert [found.reason for found in setup(tmp_path).problems] == [problem]


def test_module_is_found_in_its_package_folder(tmp_path):
    for name in ("arm/node.py", "src/leg/walk/__init__.py", "own/place/node.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    plain, moved = Setup(), Setup(folders={"": "src", "eye": "own/place"})
    assert module_file(tmp_path, plain, "arm.node") == tmp_path / "arm/node.py"
    assert module_file(tmp_path, plain, "arm.other") is None
    assert module_file(tmp_path, moved, "leg.walk") == tmp_path / "src/leg/walk/__init__.py"
    assert module_file(tmp_path, moved, "eye.node") == tmp_path / "own/place/node.py"


@pytest.mark.parametrize(
    ("name", "text", "python"),
    [
        ("a.py", "", True),
        ("a", "#!/usr/bin/env python3\nimport rospy\n", True),
        ("b", "#!/bin/sh\npython node.py\n", False),
        ("c", "import python\n", False),
        ("d.txt", "#!/usr/bin/env python3\n", False),
    ],
)
def test_python_program_is_recognised_by_name_or_first_line(tmp_path: Path, name, text, python):
    (tmp_path / name).write_text(text)
    assert is_python(tmp_path / name) is python
    assert not has_shebang(tmp_path)
    assert not has_shebang(tmp_path / "missing")


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        (" 1 ", "str", " 1 "),
        ("1", "string", "1"),
        (" 7 ", "int", 7),
        ("7", "double", 7.0),
        ("7", "float", 7.0),
        (" True ", "bool", True),
        ("1", "bool", True),
        ("FALSE", "boolean", False),
        ("0", "bool", False),
        ("1", "auto", 1),
        ("1.5", "auto", 1.5),
        ("true", "auto", True),
        ("false", "auto", False),
        (" word ", "auto", " word "),
    ],
)
def test_value_has_the_type_of_its_param_element(text, kind, value):
    found = scalar(text, kind)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(("text", "kind"), [("1.5", "int"), ("x", "double"), ("yes", "bool"), ("", "int")])
def test_a_value_of_another_type_is_refused(text, kind):
    with pytest.raises(SymbolicError, match=f"is not of type {kind}"):
        scalar(text, kind)


@pytest.mark.parametrize(
    ("sections", "found"),
    [
        ({"arm": {"ros__parameters": {"a": 1}}}, {"a": 1}),
        ({"arm": {"ros__parameters": {"a": 1}}, "leg": {"ros__parameters": {"b": 2}}}, {}),
    ],
)
def test_unnamed_node_gets_parameters_of_the_only_section(sections, found):
    assert of_node(sections, "/robot/") == found


@pytest.mark.parametrize(
    ("kind", "found"), [("GLOB", ["b.py"]), ("GLOB_RECURSE", ["a.py", "b.py"]), ("STRINGS", ["${FOUND}"])]
)
def test_cmake_variable_lists_matching_files(kind, found, tmp_path):
    (tmp_path / "deep").mkdir()
    for name in ("b.py", "deep/a.py"):
        (tmp_path / name).touch()
    *_, installed = commands(f"file({kind} FOUND *.py)\ninstall(PROGRAMS ${{FOUND}})", tmp_path, "p")
    assert sorted(Path(word).name for word in installed.words[1:]) == found
