"""What a package installs, and of what kind it is, by its files."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.workspace.cfg_files import configurations
from tarl_lint.workspace.cmake import cmake, commands
from tarl_lint.workspace.executables import build, installed
from tarl_lint.workspace.folders import folders, is_ignored, workspace_root
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.launch_py import actions_of_python
from tarl_lint.workspace.manifests import Manifest, manifest
from tarl_lint.workspace.node_programs import Program, program
from tarl_lint.workspace.read import read
from tarl_lint.workspace.ros_arguments import Given, first_of_each, ros1, ros2
from tarl_lint.workspace.setup_files import setup


def contents(folder, manifest, scripts):
    """Return what a package installs; its `CMakeLists.txt` is read first."""
    return installed(folder, manifest, scripts, build(folder, manifest))


def written(folder: Path, files: dict[str, str]) -> Path:
    """Write files with these texts into a folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text))
    return folder


@pytest.mark.parametrize(
    ("inside", "files", "kind"),
    [
        ("<export><build_type>ament_python</build_type></export>", (), "ament_python"),
        ("<export><build_type>cmake</build_type></export>", (), "cmake"),
        ("<buildtool_depend> catkin </buildtool_depend>", (), "catkin"),
        ("<buildtool_depend>ament_cmake_python</buildtool_depend>", (), "ament_cmake"),
        ("<run_depend>rospy</run_depend>", ("CMakeLists.txt",), "catkin"),
        ("<export><build_type>bazel</build_type></export>", ("CMakeLists.txt",), "cmake"),
        ("", ("setup.py",), "ament_python"),
        ("", ("setup.py", "CMakeLists.txt"), "catkin"),
        ("", (), "unknown"),
    ],
)
def test_the_kind_of_a_package_is_its_build_system(tmp_path, inside, files, kind):
    (tmp_path / "package.xml").write_text(f"<package><name>arm</name>{inside}</package>")
    for name in files:
        (tmp_path / name).touch()
    assert manifest(tmp_path)[0].kind == kind


@pytest.mark.parametrize(
    ("text", "name", "problem"),
    [
        ("<package><name> arm </name></package>", "arm", ""),
        ("<package><name> </name></package>", "folder", "it has no <name>"),
        ("<package>", "folder", "it is not XML: "),
        ("<package><name>\xff", "folder", "it is not XML: "),
        ("<!ENTITY a 'b'>", "folder", "it declares entities"),
    ],
)
def test_package_without_a_name_is_named_after_its_folder(tmp_path, text, name, problem):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/package.xml").write_bytes(text.encode("latin-1"))
    found, problems = manifest(tmp_path / "folder")
    assert found.name == name
    assert [one.reason.startswith(problem) for one in problems] == ([True] if problem else [])


def test_package_dependencies_are_sorted_and_unique(tmp_path):
    (tmp_path / "package.xml").write_text(
        "<package><name>a</name><depend>b</depend><exec_depend>c</exec_depend><run_depend> b </run_depend>"
        "<author>d</author><test_depend/></package>"
    )
    assert manifest(tmp_path)[0].dependencies == ("b", "c")


def test_a_manifest_that_is_a_folder_is_reported(tmp_path):
    (tmp_path / "package.xml").mkdir()
    found, (problem,) = manifest(tmp_path)
    assert (found.name, found.dependencies) == (tmp_path.name, ())
    assert problem.reason == "it is a folder, a named pipe or a device, not a file"


SETUP = "from setuptools import setup, find_packages\nsetup({})\n"


@pytest.mark.parametrize(
    ("given", "modules"),
    [
        ("packages=['arm', 'arm.inner', 'gone']", {"arm": "arm"}),
        ("packages='arm leg'", {"arm": "arm", "leg": "leg"}),
        ("packages=find_packages()", {"arm": "arm", "leg": "leg"}),
        ("packages=find_packages('src')", {"eye": "src/eye"}),
        ("packages=find_packages(where='src')", {"eye": "src/eye"}),
        ("packages=['eye'], package_dir={'': 'src'}", {"eye": "src/eye"}),
        ("packages=['eye'], package_dir={'eye': 'src/eye'}", {"eye": "src/eye"}),
        ("py_modules=['tool', 'gone']", {"tool": "tool.py"}),
        ("py_modules=['inner'], package_dir={'': 'src'}", {"inner": "src/inner.py"}),
        ("packages=find_packages('nowhere')", {}),
        ("name='arm'", {}),
    ],
)
def test_the_modules_that_setup_files_install_are_found(tmp_path, given, modules):
    written(
        tmp_path,
        {
            "arm/__init__.py": "",
            "leg/__init__.py": "",
            "test/__init__.py": "",
            "src/eye/__init__.py": "",
            "src/inner.py": "",
            "tool.py": "",
            "docs/a.txt": "",
            "setup.py": SETUP.format(given),
        },
    )
    found = contents(tmp_path, Manifest("arm", "ament_python"), [])[1]
    assert {one.name: one.path.relative_to(tmp_path).as_posix() for one in found} == modules


def test_package_of_unknown_kind_has_a_module_of_its_name(tmp_path):
    written(tmp_path, {"arm/__init__.py": ""})
    assert [one.name for one in contents(tmp_path, Manifest("arm", "unknown"), [])[1]] == ["arm"]
    assert contents(tmp_path, Manifest("arm", "catkin"), [])[1] == ()
    assert contents(tmp_path, Manifest("leg", "unknown"), [])[1] == ()


def test_package_programs_include_scripts_and_installed_files(tmp_path):
    written(
        tmp_path,
        {
            "arm/node.py": "",
            "bin/run": "#!/usr/bin/env python3\n",
            "nodes/a.py": "",
            "nodes/b.sh": "",
            "CMakeLists.txt": "install(PROGRAMS nodes/a.py nodes/b.sh nodes/gone.py ${X}/c.py DESTINATION lib/arm)",
            "setup.py": SETUP.format(
                "scripts=['bin/run', 'bin/gone'],"
                " entry_points={'console_scripts': ['n = arm.node:main', 'm=arm.no:f.g [x]']}"
            ),
        },
    )
    scripts = [tmp_path / "nodes/a.py", tmp_path / "other"]
    programs, _, problems = contents(tmp_path, Manifest("arm", "catkin"), scripts)
    assert [(one.name, one.path and one.path.name, one.entry, one.module) for one in programs] == [
        ("a.py", "a.py", None, ""),
        ("gone", None, None, ""),
        ("gone.py", None, None, "nodes/gone.py"),
        ("m", None, "f.g", "arm.no"),
        ("n", "node.py", "main", "arm.node"),
        ("other", "other", None, ""),
        ("run", "run", None, ""),
    ]
    assert [one.reason for one in problems] == [
        "install: the value of ${X}/c.py is not known",
        "m is installed, but its file arm.no does not exist",
        "gone is installed, but its file gone does not exist",
        "gone.py is installed, but its file nodes/gone.py does not exist",
    ]
    python = contents(tmp_path, Manifest("arm", "ament_python"), scripts)[0]
    assert [one.name for one in python] == ["gone", "m", "n", "run"]


@pytest.mark.parametrize(
    ("given", "console", "problems"),
    [
        ("entry_points='[console_scripts]\\na = b:c\\n[other]\\nd = e:f'", [("a", "b", "c")], []),
        ("entry_points={'console_scripts': 'a = b:c\\nd-e = f.g:h.i'}", [("a", "b", "c"), ("d-e", "f.g", "h.i")], []),
        ("entry_points={'other': ['a = b:c']}", [], []),
        ("entry_points={'console_scripts': ['a = b']}", [],
         ["the console script `a = b` is not `name = module:function`"]),
        ("entry_points={'console_scripts': names()}", [], ["`console_scripts` is not constant"]),
        ("entry_points=names()", [], ["`entry_points` is not constant"]),
        ("package_dir=names()", [], ["`package_dir` is not constant"]),
    ],
)  # fmt: skip
def test_console_scripts_are_read_from_lists_and_texts(tmp_path, given, console, problems):
    (tmp_path / "setup.py").write_text(SETUP.format(given))
    found = setup(tmp_path)
    assert found.console == tuple(console)
    assert [one.reason for one in found.problems] == problems


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("setup.py", "x = 1\n", "it has no call of setup that can be followed"),
        ("setup.py", "x = (\n", "it is not Python 3: "),
        ("setup.cfg", "packages = a\n", "it cannot be read: File contains no section headers."),
    ],
)
def test_setup_files_that_cannot_be_read_are_reported(tmp_path, name, text, reason):
    (tmp_path / name).write_text(text)
    (problem,) = setup(tmp_path).problems
    assert (problem.file.name, problem.reason.startswith(reason)) == (name, True)


def test_setup_py_takes_precedence_over_setup_cfg(tmp_path):
    (tmp_path / "setup.cfg").write_text("[options]\npackages =\n    a\n    b\npy_modules = c\n")
    assert setup(tmp_path).packages == ("a", "b")
    (tmp_path / "setup.py").write_text(SETUP.format("packages=['d']"))
    assert (setup(tmp_path).packages, setup(tmp_path).modules) == (("d",), ("c",))


CMAKE = {
    "installed folders": ("install(DIRECTORY nodes DESTINATION lib/${PROJECT_NAME})",
        {"nodes/a.py": "a.py", "nodes/b": "b"}),
    "folders installed elsewhere": ("install(DIRECTORY nodes DESTINATION share/arm)", {}),
    "files as programs": ("install(FILES nodes/a.py nodes/no.py DESTINATION bin)", {"nodes/a.py": "a.py"}),
    "files elsewhere": ("install(FILES nodes/a.py DESTINATION binary)", {}),
    "a pattern": ("file(GLOB N nodes/*.py)\ninstall(PROGRAMS ${N} DESTINATION bin)", {"nodes/a.py": "a.py"}),
    "a pattern of whole paths": (
        "file(GLOB N ${PROJECT_SOURCE_DIR}/nodes/*.py)\ninstall(PROGRAMS ${N} DESTINATION bin)",
        {"nodes/a.py": "a.py"},
    ),
    "a pattern below": (
        "file(GLOB_RECURSE N *.py)\ninstall(PROGRAMS ${N} DESTINATION bin)",
        {"nodes/a.py": "a.py", "nodes/deep/c.py": "c.py"},
    ),
    "a pattern without its folders": ("file(GLOB N *.py)\ninstall(PROGRAMS ${N} DESTINATION bin)", {}),
    "a relative pattern": (
        "file(GLOB N RELATIVE ${CMAKE_SOURCE_DIR} nodes/*.py ../*.py /*.py)\ninstall(PROGRAMS ${N} DESTINATION bin)",
        {"nodes/a.py": "a.py"},
    ),
    "an invalid pattern": ("file(GLOB N nodes/**x/*.py a)\ninstall(PROGRAMS ${N} nodes/b DESTINATION bin)",
        {"nodes/b": "b"}),
    "an extended list": ("set(N nodes/b)\nlist(APPEND N nodes/a.py)\ninstall(PROGRAMS ${N} DESTINATION bin)",
        {"nodes/a.py": "a.py", "nodes/b": "b"}),
    "whole paths": ("install(PROGRAMS ${CMAKE_CURRENT_SOURCE_DIR}/nodes/b DESTINATION bin)", {"nodes/b": "b"}),
    "another name": ("install(PROGRAMS nodes/b DESTINATION bin RENAME c)", {"nodes/b": "c"}),
    "an unknown variable": ("install(PROGRAMS ${N} DESTINATION bin)", {}),
    "a list in a variable": ('set(N "nodes/a.py;nodes/b")\ninstall(PROGRAMS ${N}x DESTINATION bin)',
        {"nodes/a.py": "a.py", "nodes/bx": "bx"}),
    "a variable without words": ("set(N)\ninstall(PROGRAMS ${N} nodes/b DESTINATION bin)", {"nodes/b": "b"}),
    "upper case": ("INSTALL(PROGRAMS nodes/b DESTINATION bin)", {"nodes/b": "b"}),
    "nothing": ("install()\nset()\nfile(GLOB)", {}),
}  # fmt: skip


@pytest.mark.parametrize("name", CMAKE)
def test_the_programs_that_cmake_installs_are_found(tmp_path, name):
    text, programs = CMAKE[name]
    written(tmp_path, {"nodes/a.py": "", "nodes/b": "", "nodes/deep/c.py": "", "CMakeLists.txt": text})
    assert dict(cmake(tmp_path, "arm").programs) == programs


def test_quoted_cmake_words_stay_together(tmp_path):
    text = 'set(A "x y") #[==[ set(A z) ]==] # set(A w)\nf(${A} "${A} b" c"d" (e (f)) )\n)g(h)'
    assert [(one.name, one.words) for one in commands(text, tmp_path, "arm")] == [
        ("set", ("A", "x y")),
        ("f", ("x y", "x y b", "c", "d", "e", "f")),
        ("f", ()),
        ("g", ("h",)),
    ]


def test_a_large_or_unreadable_cmake_file_is_reported(tmp_path):
    (tmp_path / "CMakeLists.txt").write_text("#" * 500_001)
    (problem,) = cmake(tmp_path, "arm").problems
    assert problem.reason == "it has more than 500,000 bytes"


CFG = """\
from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
{}
gen.generate('p', 'n', 'Arm')
"""


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("gen.add(names(), int_t, 0, 'd', 1)", "the name or type of a parameter is not constant"),
        ("gen.add('a', names(), 0, 'd', 1)", "the name or type of a parameter is not constant"),
        ("gen.add('a', int_t, 0, 'd', 'x')", "the default of a is not of type int"),
        ("gen.add('a', double_t, 0, 'd', 1, 'x')", "the min of a is not of type double"),
        ("gen.add('a', double_t, 0, 'd', 1, 0, names())", "the max of a is not constant"),
        ("gen.const('A', int_t, names(), 'd')", "a constant's name or value is not constant"),
        ("gen.const(names(), int_t, 1, 'd')", "a constant's name or value is not constant"),
    ],
)
def test_non_constant_parameter_is_reported_with_its_line(tmp_path, line, problem):
    (tmp_path / "Arm.cfg").write_text(CFG.format(line))
    (_, (found,)) = configurations(tmp_path / "Arm.cfg")
    assert (found.line, found.reason) == (3, problem)


def test_nested_cfg_groups_name_their_enclosing_groups(tmp_path):
    lines = "a = gen.add_group('A b', state=False)\nb = a.add_group('C')\nb.add('x', bool_t, 0, names())"
    (tmp_path / "Arm.cfg").write_text(CFG.format(lines))
    ((found,), _) = configurations(tmp_path / "Arm.cfg")
    (outer,) = found.description["groups"]
    (inner,) = outer["groups"]
    assert (outer["id"], outer["parent"], outer["cstate"], outer["lower"]) == (1, 0, "false", "a_b")
    assert (inner["id"], inner["parent"], inner["parentname"], inner["cstate"]) == (2, 1, "A_b", "true")
    assert (inner["class"], inner["parentclass"], inner["field"]) == (
        "DEFAULT::A_B::C",
        "DEFAULT::A_B",
        "DEFAULT::A_B::c",
    )
    assert found.description["lower"] == "groups"
    assert [(one["default"], one["description"], one["edit_method"]) for one in inner["parameters"]] == [
        (False, "", "")
    ]


def test_tool_folders_are_skipped_and_ignored_ones_noted(tmp_path):
    for name in (
        "a",
        "build",
        "log",
        ".git",
        "__pycache__",
        "node_modules",
        "install",
        "marked/in",
        "venv",
        "z",
    ):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "log/__init__.py").touch()
    (tmp_path / "marked/AMENT_IGNORE").touch()
    (tmp_path / "venv/pyvenv.cfg").touch()
    (tmp_path / "COLCON_IGNORE").touch()
    markers: list[Path] = []
    found = [folder.relative_to(tmp_path).as_posix() for folder, _ in folders(tmp_path, ignored=markers)]
    assert found == [".", "a", "log", "z"]
    assert markers == [tmp_path / "marked/AMENT_IGNORE"]
    kept = folders(tmp_path, frozenset([tmp_path / "marked/in"]))
    assert [folder.name for folder, _ in kept] == [tmp_path.name, "a", "log", "marked", "in", "z"]
    assert is_ignored(tmp_path / "marked/in", tmp_path)
    assert not is_ignored(tmp_path / "a", tmp_path)


def test_workspace_root_is_the_src_folder_or_the_repository(
    tmp_path,
):
    inner = tmp_path / "ws/src/group/arm/arm"
    inner.mkdir(parents=True)
    file = inner / "node.py"
    file.touch()
    assert workspace_root(inner) is None
    (inner / "package.xml").touch()
    assert workspace_root(inner) == inner.parent
    (inner.parent / "package.xml").touch()
    assert workspace_root(file) == tmp_path / "ws/src/group"
    (tmp_path / "ws/devel").mkdir()
    assert workspace_root(file) == tmp_path / "ws/src"
    (tmp_path / "ws/src/group/.git").mkdir()
    assert workspace_root(file) == tmp_path / "ws/src/group"


def test_launch_folder_may_contain_files_with_other_endings(tmp_path):
    written(
        tmp_path,
        {
            "package.xml": "<package><name>arm</name></package>",
            "launch/a.xml": "<launch/>",
            "launch/b.xml": "<robot/>",
            "launch/c.py": "def generate_launch_description():\n    return 1\n",
            "launch/d.py": "x = 1\n",
            "other/e.xml": "<launch/>",
            "other/f.launch.yaml": "",
            "cfg/g.cfg": "[a]\n",
            "msg/M.msg": "",
            "msg/N.srv": "",
            "config/h.yml": "",
        },
    )
    (package,) = read(tmp_path).packages
    names = [
        [one.name for one in some]
        for some in (
            package.launch_files,
            package.configurations,
            package.parameter_files,
            package.interfaces,
        )
    ]
    assert names == [["a.xml", "c.py", "f.launch.yaml"], [], ["h.yml"], ["M.msg"]]


def test_interfaces_outside_packages_belong_to_their_folder(tmp_path):
    written(tmp_path, {"loose/srv/S.srv": "", "loose/msg/readme": ""})
    (package,) = read(tmp_path).packages
    assert (package.name, package.kind, [one.name for one in package.interfaces]) == (
        "loose",
        "unknown",
        ["S.srv"],
    )


def test_node_program_is_found_or_explained(tmp_path):
    written(
        tmp_path,
        {
            "arm/package.xml": "<package><name>arm</name>"
            "<export><build_type>ament_python</build_type></export></package>",
            "arm/setup.py": SETUP.format(
                "entry_points={'console_scripts': ['a = arm.node:main', 'g = arm.gone:main']}"
            ),
            "arm/arm/node.py": "",
            "arm/deep/er/tool.py": "",
            "arm/deep/tool.py": "",
            "leg/tool.py": "",
        },
    )
    workspace = read(tmp_path)
    files = sorted(tmp_path.rglob("*.py"))

    def of(executable: str, package: str = "arm", kind: str = "node") -> Program | str:
        node = LaunchedNode(package, executable, "n", "/", tmp_path, 1, kind=kind)  # type: ignore[arg-type]
        return program(node, workspace, files)

    assert of("a") == Program(tmp_path / "arm/arm/node.py", "main")
    assert of("tool.py") == Program(tmp_path / "arm/deep/tool.py")
    assert of("g") == "arm.gone of arm, in which g begins, does not exist"
    assert of("h") == "no Python program h in arm"
    assert of("a", "eye") == "the package eye is not in the workspace"
    assert of("a", kind="component") == "a composable node"
    assert of("a", kind="container") == "a container of composable nodes"


def test_modules_beside_a_launch_file_are_interpreted(tmp_path):
    written(
        tmp_path,
        {
            "package.xml": "<package><name>arm</name></package>",
            "launch/parts.py": "from launch_ros.actions import Node\nNAME = 'x'\n"
            "def made():\n    return Node(package='p', executable=NAME)\n",
            "launch/more/__init__.py": "from parts import NAME\n",
            "launch/a.launch.py": "import parts, more\nfrom launch import LaunchDescription\n"
            "def generate_launch_description():\n    return LaunchDescription([parts.made(), more.NAME])\n",
        },
    )
    problems: list = []
    action = actions_of_python(tmp_path / "launch/a.launch.py", read(tmp_path), problems)
    made, name = action.values["actions"]
    assert (made.kind, made.values["executable"], name, problems) == ("node", "x", "x", [])


def test_arguments_of_nodes_are_read_as_ros_reads_them():
    assert ros1("a:=b _c:=1 __ns:=/n __name:=m d:=true /x/y:=~z 'e f' g:=-1 'h:=(") == Given(
        (("a", "b"), ("/x/y", "~z")), (("~c", "1"),), (), "", "/n"
    )
    assert ros2("-r a:=b") == Given()
    assert ros2(
        "x --ros-args -r a:=b --remap __node:=m -r __ns:=/n -p c:=[1] --log-level debug --params-file f.yaml"
    ) == (Given((("a", "b"),), (("~c", "[1]"),), ("f.yaml",), "m", "/n"))
    assert ros2("--ros-args -r a:=b -- -r c:=d --ros-args -r e:=f") == Given((("a", "b"), ("e", "f")))
    assert ros2("--ros-args -r __name:=m -r __node:=o -p x:=1 -r") == Given((), (("~x", "1"),), (), "m")


def test_first_remapping_of_each_name_counts():
    pairs = [
        ("a", "b"),
        ("/n/a", "c"),
        ("m:d", "e"),
        ("o:f", "g"),
        ("/n/m:h", "i"),
        ("~j", "k"),
        ("/n/m/j", "l"),
    ]
    assert first_of_each(pairs, "/n", "m") == (("a", "b"), ("d", "e"), ("h", "i"), ("~j", "k"))


def called(tmp_path, text):
    found = commands(dedent(text), tmp_path, "arm")
    return [one.words for one in found if one.name == "add_executable"]


def test_macros_and_loops_of_cmake_are_expanded(tmp_path):
    text = """
        macro(program T)
          add_executable(${T} ${T}/${T}.cpp ${ARGN})
        endmacro()
        function(Both one two)
          program(${one} extra.cpp)
          program(${two})
        endfunction()
        set(MORE e f)
        foreach(dir a b)
          foreach(side left right)
            program(${dir}_${side})
          endforeach()
        endforeach()
        both(c d)
        foreach(dir IN LISTS MORE ITEMS g)
          program(${dir})
        endforeach()
        add_executable(${T} last.cpp)
        """
    assert called(tmp_path, text) == [
        *((f"{one}_{side}", f"{one}_{side}/{one}_{side}.cpp") for one in "ab" for side in ("left", "right")),
        ("c", "c/c.cpp", "extra.cpp"),
        ("d", "d/d.cpp"),
        *((one, f"{one}/{one}.cpp") for one in "efg"),
        ("${T}", "last.cpp"),
    ]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("macro(a)\nadd_executable(x)\na()\nendmacro()\na()", 8),
        ("foreach(x RANGE 9)\nadd_executable(x)\nendforeach()\nadd_executable(y)", 1),
        ("foreach(x a b)\nadd_executable(${x})", 0),
        ("macro()\nadd_executable(x)\nendmacro()\nadd_executable(y)", 1),
        ("set(a x)\n" + "set(a ${a}${a} ${a})\n" * 200 + "add_executable(${a})", 1),
        (
            "set(l 1 2 3 4 5 6 7 8 9)\n"
            + "foreach(x ${l})\n" * 7
            + "add_executable(x)\n"
            + "endforeach()\n" * 7,
            None,
        ),
    ],
)
def test_reading_endless_and_unfinished_blocks_of_cmake_ends(tmp_path, text, number):
    found = called(tmp_path, text)
    assert len(found) < 10_000 if number is None else len(found) == number


def test_message_package_wins_over_a_copy(tmp_path: Path) -> None:
    folders = {
        "a_first/arm_msgs/msg/Old.msg": "float64 value",
        "a_first/arm_msgs/msg/Grip.msg": "float64 old",
        "arm_msgs/srv/Grip.srv": "---",
        "src/arm_msgs/package.xml": "<package><name>arm_msgs</name></package>",
        "src/arm_msgs/msg/Grip.msg": "float64 force",
        "src/arm_msgs/srv/Move.srv": "---",
        "z_again/arm_msgs/package.xml": "<package><name>arm_msgs</name></package>",
        "z_again/arm_msgs/msg/Other.msg": "float64 value",
    }
    for name, text in folders.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (package,) = read(tmp_path).packages
    assert package.folder == tmp_path / "src/arm_msgs"
    assert [str(one.relative_to(tmp_path)) for one in package.interfaces] == [
        "src/arm_msgs/msg/Grip.msg",
        "src/arm_msgs/srv/Move.srv",
        "a_first/arm_msgs/msg/Old.msg",
        "arm_msgs/srv/Grip.srv",
    ]


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        ("install(PROGRAMS nodes/a.py ${N} DESTINATION bin)", [(1, "install: the value of ${N} is not known")]),
        ("\ncatkin_install_python(PROGRAMS ${N}/a.py)",
         [(2, "catkin_install_python: the value of ${N}/a.py is not known")]),
        ("list(APPEND N nodes/a.py)\ninstall(PROGRAMS ${N} DESTINATION bin)", []),
        ("add_subdirectory(sub)", [(1, "add_subdirectory: sub/CMakeLists.txt is not read")]),
        ("include(sub/CMakeLists.txt)", [(1, "include: sub/CMakeLists.txt is not read")]),
        ("include(empty.cmake)\ninclude(CTest)", []),
        ("install(DIRECTORY ${N} DESTINATION lib/arm)", [(1, "install: the value of ${N} is not known")]),
        ("install(DIRECTORY ${N} DESTINATION share/arm)", []),
        ("install(TARGETS ${N} RUNTIME DESTINATION bin)", []),
        ("install(PROGRAMS nodes/a.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})", []),
        ("ament_python_install_package(${N})", [(1, "ament_python_install_package: the value of ${N} is not known")]),
        ("add_executable(${N} a.cpp)", [(1, "add_executable: the value of ${N} is not known")]),
        ("add_executable(a ${SOURCES})", [(1, "add_executable: the value of ${SOURCES} is not known")]),
        ("macro(f N)\nadd_executable(${N} a.cpp)\nendmacro()\nf(servo)", []),
        ("project(a", [(1, "a parenthesis is not closed")]),
        ('project("a)\n', [(1, "a quoted text is not closed")]),
        ("\nif(A)\n  foreach(x a b)\nendforeach()\n", [(2, "if() is not closed")]),
        ("# if(\n#[[ ( ]]\nproject(a)", []),
        ("add_message_files(FILES Gone.msg)", [(1, "msg/Gone.msg is declared, but does not exist")]),
        ("add_service_files(DIRECTORY s FILES Gone.srv)", [(1, "s/Gone.srv is declared, but does not exist")]),
        ("rosidl_generate_interfaces(arm action/Gone.action)",
         [(1, "action/Gone.action is declared, but does not exist")]),
        ("rosidl_generate_interfaces(arm ${FILES})", []),
        ("generate_dynamic_reconfigure_options(cfg/Gone.cfg)", [(1, "cfg/Gone.cfg is declared, but does not exist")]),
    ],
)  # fmt: skip
def test_parts_of_cmake_that_cannot_be_read_are_named(tmp_path, text, problems):
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes/a.py").touch()
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/CMakeLists.txt").write_text("add_executable(more more.cpp)")
    (tmp_path / "empty.cmake").touch()
    (tmp_path / "CMakeLists.txt").write_text(text)
    assert [(one.line, one.reason) for one in cmake(tmp_path, "arm").problems] == problems
