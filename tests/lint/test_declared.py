"""Entry points that packages declare are read as text from every kind of file."""

import pytest

from tarl_lint.read.declared_entry_points import Declarations


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ("setup.py", "setup(entry_points={'console_scripts': ['run = arm.node:start']})"),
        ("setup.cfg", "[options.entry_points]\nconsole_scripts =\n    run = arm.node:start\n"),
        ("pyproject.toml", '[project.scripts]\nrun = "arm.node:start"\n'),
        ("plugin.xml", '<class name="Arm" type="arm.node.start" base_class_type="rqt_gui_py::Plugin"/>'),
        ("my_plugins.xml", '<class name="Arm" type="arm.node.start"/>'),
        ("resource/arm.urdf", '<plugin type="arm.node.start" />'),
        ("urdf/arm.xacro", '<plugin type="arm.node.start"></plugin>'),
    ],
)
def test_entry_points_are_found_in_every_kind_of_description(tmp_path, place, text):
    (tmp_path / "package.xml").write_text("<package/>")
    file = tmp_path / place
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    declared = Declarations()
    assert declared.of(f"{tmp_path}/arm/node.py", "arm.node") == ("start",)
    assert declared.of(f"{tmp_path}/arm/other.py", "arm.other") == ()


@pytest.mark.parametrize("naming", ["package.xml", "CMakeLists.txt"])
@pytest.mark.parametrize("place", ["extras.xml", "../extras.xml", "/extras.xml"])
def test_oddly_named_plugin_description_counts_only_in_its_package(tmp_path, naming, place):
    package = tmp_path / "arm"
    package.mkdir()
    (package / "package.xml").write_text("<package/>")
    (package / naming).write_text(f'<package>plugin="${{prefix}}/{place}"</package>')
    described = '<class type="arm.node.Arm"/>'
    (tmp_path / "extras.xml").write_text(described)
    assert Declarations().of(f"{package}/arm/node.py", "arm.node") == ()
    (package / "extras.xml").write_text(described)
    assert Declarations().of(f"{package}/arm/node.py", "arm.node") == (() if place[:2] == ".." else ("Arm",))


def test_missing_and_unreadable_descriptions_declare_nothing(tmp_path):
    assert Declarations().of(f"{tmp_path}/node.py", "node") == ()
    (tmp_path / "setup.py").mkdir()
    (tmp_path / "plugin.xml").write_bytes(b"\xff\xfe<class type=")
    (tmp_path / "package.xml").write_text("<package/>")
    assert Declarations().of(f"{tmp_path}/node.py", "node") == ()


def test_code_of_a_setup_script_is_not_run(tmp_path):
    (tmp_path / "setup.py").write_text("entry_points = 1\nopen('ran', 'w')\nraise SystemExit(3)\n")
    assert Declarations().of(f"{tmp_path}/node.py", "node") == ()
    assert not (tmp_path / "ran").exists()
