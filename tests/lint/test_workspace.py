"""A workspace is read as text: packages, programs, modules, configurations, and problems."""

from __future__ import annotations

import ast
import os
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from tarl_lint.workspace.cfg_files import configurations
from tarl_lint.workspace.cmake import cmake
from tarl_lint.workspace.manifests import manifest
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.python.evaluator import Unknown
from tarl_lint.workspace.python.interpreter import Interpreter
from tarl_lint.workspace.read import read
from tarl_lint.workspace.setup_files import setup


def write(folder: Path, **texts: str) -> Path:
    """Write files; in a name, `__` stands for a slash and `_DOT_` for a dot."""
    for name, text in texts.items():
        path = folder / name.replace("__", "/").replace("_DOT_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text))
    return folder


def package(folder: Path, name: str, build: str = "") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    stated = f"<export><build_type>{build}</build_type></export>" if build else "<depend>catkin</depend>"
    (folder / "package.xml").write_text(
        f"<package><name>{name}</name><depend>std_msgs</depend>{stated}</package>"
    )
    return folder


def interpreted(tmp_path: Path, text: str, **models: Any) -> dict[str, Any]:
    path = tmp_path / "read.py"
    path.write_text(dedent(text))
    return Interpreter(path, {name.replace("__", "."): one for name, one in models.items()}).run()


CONSTANT = """
import math
from os import path
package = "arm"
files = ["%s/%d" % (package, i) for i in range(3) if i != 1]
text = f"{package}_{1 + 2}" + "-".join(["a", "b"]).upper()
table = {"a": [1, 2.5, -3], **{"b": (True, None)}}
first, *_ = [1, 2] if len(files) == 2 else [3, 4]
where = path.join("share", package, "cfg")
angle = round(math.degrees(math.pi) if False else math.pi * 2, 3)
total = 0
for i in range(10):
    if i == 4:
        continue
    if i > 6:
        break
    total += i
def double(x, y=2):
    return x * y
six = double(3)
nine = double(3, y=3)
chosen = table["a"][-1] if "a" in table and not table.get("c") else None
"""


def test_constant_values_are_those_that_python_computes(tmp_path: Path) -> None:
    names = interpreted(tmp_path, CONSTANT)
    real: dict[str, Any] = {}
    exec(CONSTANT, real)
    for name in ("files", "text", "table", "where", "angle", "total", "six", "nine", "chosen"):
        assert names[name] == real[name], name


MORE = """
import functools, itertools, math, os.path
from collections import namedtuple
pairs = [f"{a!r}{b:03d}" for a, b in zip("xy", range(2)) if b is not None]
table = {key: value for key, (value, _) in {"a": (1, 2), "b": (3, 4)}.items()}
first, *middle, last = sorted([3, 1, 2, 5], key=lambda one: -one)
chain = list(itertools.chain([1], (2,))) + [x * y for x, y in itertools.product([1, 2], [3])]
Point = namedtuple("Point", "x y")
x, y = Point(1, y=2)
def many(*args, sep="-", **rest):
    return sep.join(map(str, args)) + "".join(sorted(rest))
text = many(1, 2, sep="+", b=0, a=0)
class Base:
    scale = 2
    def __init__(self, value): self.value = value
    def times(self): return self.value * self.scale
class Derived(Base):
    scale = 5
    def times(self): return super().times() + 1
number = Derived(3).times()
def outer():
    seen = 0
    def inner():
        nonlocal seen
        seen += 2
    inner(); inner()
    return seen
closed = outer()
total = 0
for i in range(3):
    total += i
else:
    total += 100
rows = [[0] * 2 for _ in range(2)]
rows[1][0] += 7
alias = rows
alias += [[9]]
path = os.path.splitext(os.path.normpath("/a/../b/c.yaml"))[0]
kinds = [isinstance(one, (str, list)) for one in ("a", [1], 3)]
merged = {**{"a": 1}, "b": 2} | {"c": 3}
flat = sum([[1], [2, 3]], [])
part = "key=value".partition("=")[2].zfill(8)
"""


def test_functions_classes_and_loops_are_interpreted_as_python_does(tmp_path: Path) -> None:
    names = interpreted(tmp_path, MORE)
    real: dict[str, Any] = {}
    exec(MORE, real)
    for name in ("pairs", "table", "first", "middle", "last", "chain", "x", "y", "text", "number", "closed", "total",
                 "rows", "path", "kinds", "merged", "flat", "part"):  # fmt: skip
        assert names[name] == real[name], name


def test_non_constant_values_are_unknown_and_nothing_is_executed(tmp_path: Path) -> None:
    names = interpreted(
        tmp_path,
        f"""
        import os
        os.system("touch {tmp_path}/executed")
        home = os.environ["HOME"]
        text = "x" + home
        huge = "x" * 10**12
        wide = "%999999999d" % 1
        inside = "{{0.__class__}}".format(1).__class__
        parts = [1, home, 2]
        open("{tmp_path}/executed", "w").write("x")
        """,
    )
    assert not (tmp_path / "executed").exists()
    assert all(isinstance(names[name], Unknown) for name in ("home", "text", "huge", "wide", "inside"))
    assert names["parts"][0] == 1
    assert isinstance(names["parts"][1], Unknown)


@pytest.mark.parametrize(
    "text",
    ["while True:\n    x = 1", "def f():\n    return f()\nx = f()", "for i in range(10**9):\n    pass",
     "x = [" * 90 + "]" * 90, "for i in range(90000):\n    x = i\n"],
)  # fmt: skip
def test_only_the_beginning_of_an_endless_file_is_read(tmp_path: Path, text: str) -> None:
    assert isinstance(interpreted(tmp_path, text), dict)


CFG = """
#!/usr/bin/env python
from dynamic_reconfigure.parameter_generator_catkin import *
from math import pi
gen = ParameterGenerator()
gen.add("rate", double_t, 1, "how often", 10, 1, 100.0)
gen.add("turn", double_t, 0, "angle", pi)
sizes = gen.enum([gen.const("Small", int_t, 0, "s"), gen.const("Large", int_t, 2, "l")], "sizes")
gen.add("size", int_t, 4, "size", 2, 0, 2, edit_method=sizes)
limits = gen.add_group("speed limits", type="tab")
for axis in ("x", "y"):
    limits.add("max_%s" % axis, double_t, 0, "limit", 0.5, 0.0)
gen.add("name", str_t, 0, "a name", "arm")
gen.add("on", bool_t, 0, "a switch", True)
exit(gen.generate("arm", "arm_node", "Arm"))
"""


def test_configurations_are_interpreted(tmp_path: Path) -> None:
    (tmp_path / "Arm.cfg").write_text(CFG)
    (found,), problems = configurations(tmp_path / "Arm.cfg")
    assert not problems
    assert (found.name, found.constants) == ("Arm", {"Arm_Small": 0, "Arm_Large": 2})
    top = {one["name"]: one for one in found.description["parameters"]}
    assert (top["rate"]["default"], top["rate"]["min"], top["rate"]["max"]) == (10.0, 1.0, 100.0)
    assert type(top["rate"]["default"]) is float
    assert (top["turn"]["min"], top["turn"]["max"]) == (float("-inf"), float("inf"))
    assert (top["size"]["level"], ast.literal_eval(top["size"]["edit_method"])["enum"][1]["value"]) == (4, 2)
    (group,) = found.description["groups"]
    assert (group["name"], group["class"], group["field"]) == (
        "speed_limits", "DEFAULT::SPEED_LIMITS", "DEFAULT::speed_limits",
    )  # fmt: skip
    assert [one["name"] for one in group["parameters"]] == ["max_x", "max_y"]


def test_non_constant_values_in_a_cfg_file_are_reported(tmp_path: Path) -> None:
    text = CFG.replace("10, 1, 100.0", "rospy.get_param('rate'), 1, 100.0").replace('"Arm")', "name)")
    (tmp_path / "Arm.cfg").write_text(text)
    found, problems = configurations(tmp_path / "Arm.cfg")
    assert not found
    assert [(one.line, one.reason) for one in problems] == [
        (6, "the default of rate is not constant"),
        (0, "no call of generate with a constant name was found"),
    ]


def test_setup_files_are_interpreted(tmp_path: Path) -> None:
    write(
        tmp_path,
        setup_DOT_py="""
        from glob import glob
        from setuptools import find_packages, setup
        package_name = "arm"
        with open("README.md") as readme:
            text = readme.read()
        setup(
            name=package_name,
            long_description=text,
            packages=find_packages("src", exclude=["test"]),
            package_dir={"": "src"},
            data_files=[("share/" + package_name, glob("launch/*.py"))],
            entry_points={"console_scripts": [f"{package_name}_node = {package_name}.node:main", "bad"]},
        )
        """,
    )
    found = setup(tmp_path)
    assert (found.packages, found.folders, found.console) == (
        None,
        {"": "src"},
        (("arm_node", "arm.node", "main"),),
    )
    assert [one.reason for one in found.problems] == [
        "the console script `bad` is not `name = module:function`"
    ]


def test_catkin_setup_and_setup_cfg_are_read(tmp_path: Path) -> None:
    write(
        tmp_path / "a",
        setup_DOT_py="""
        from distutils.core import setup
        from catkin_pkg.python_setup import generate_distutils_setup
        d = generate_distutils_setup(packages=["arm", "arm.parts"], package_dir={"": "src"}, scripts=["bin/arm"])
        setup(**d)
        """,
    )
    assert (setup(tmp_path / "a").packages, setup(tmp_path / "a").scripts) == (
        ("arm", "arm.parts"),
        ("bin/arm",),
    )
    write(
        tmp_path / "b",
        setup_DOT_cfg="""
        [options]
        packages = find:
        package_dir =
            = lib
        [options.packages.find]
        where = lib
        [options.entry_points]
        console_scripts =
            arm = arm.node:main
        """,
    )
    found = setup(tmp_path / "b")
    assert (found.packages, found.folders, found.console) == (
        None,
        {"": "lib"},
        (("arm", "arm.node", "main"),),
    )


def test_cmake_files_are_read(tmp_path: Path) -> None:
    write(
        tmp_path,
        CMakeLists_DOT_txt="""
        project(arm)  # install(PROGRAMS not/this DESTINATION bin)
        #[[ catkin_python_setup() ]]
        catkin_python_setup()
        set(SCRIPTS scripts/a.py scripts/b)
        catkin_install_python(PROGRAMS ${SCRIPTS} DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
        install(PROGRAMS nodes/c.py DESTINATION lib/${PROJECT_NAME} RENAME c)
        install(FILES nodes/d.yaml DESTINATION share/${PROJECT_NAME})
        install(DIRECTORY nodes/ DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} USE_SOURCE_PERMISSIONS)
        ament_python_install_package(${PROJECT_NAME} PACKAGE_DIR python/arm)
        """,
        nodes__e_DOT_py="",
    )
    found = cmake(tmp_path, "arm")
    assert dict(found.programs) == {
        "scripts/a.py": "a.py", "scripts/b": "b", "nodes/c.py": "c", "nodes/e.py": "e.py",
    }  # fmt: skip
    assert (found.uses_setup, found.python_packages) == (True, (("arm", "python/arm"),))


def test_manifests_give_the_build_type_without_entities(tmp_path: Path) -> None:
    assert manifest(package(tmp_path / "a", "arm"))[0].kind == "catkin"
    assert manifest(package(tmp_path / "b", "arm", "ament_python"))[0].kind == "ament_python"
    write(tmp_path / "c", package_DOT_xml="<!DOCTYPE x [<!ENTITY a 'b'>]><package><name>&a;</name></package>")
    found, problems = manifest(tmp_path / "c")
    assert (found.name, [one.reason for one in problems]) == ("c", ["it declares entities"])


def workspace(tmp_path: Path) -> Workspace:
    base = package(tmp_path / "ws/src/arm_base", "arm_base")
    write(
        base,
        CMakeLists_DOT_txt="catkin_python_setup()\ninstall(PROGRAMS scripts/drive gone.py DESTINATION bin)",
        setup_DOT_py="from distutils.core import setup\nsetup(packages=['controllers'], package_dir={'': 'src'})",
        src__controllers____init___DOT_py="",
        msg__Reading_DOT_msg="float64 value",
        cfg__Arm_DOT_cfg=CFG,
        launch__arm_DOT_launch="<launch/>",
        config__arm_DOT_yaml="kp: 1.0",
        scripts__drive="#!/usr/bin/env python\n",
        scripts__tune="#!/usr/bin/env python3\n",
    )
    init = base / "src/controllers/__init__.py"
    init.parent.mkdir(parents=True, exist_ok=True)
    init.write_text("")
    os.chmod(base / "scripts/tune", 0o755)  # noqa: PTH101
    control = package(tmp_path / "ws/src/arm_control", "arm_control", "ament_python")
    write(
        control,
        setup_DOT_py="""
        from setuptools import setup
        setup(packages=['arm_control'], entry_points={'console_scripts': ['control = arm_control.node:main',
                                                                          'gone = arm_control.gone:main']})
        """,
        arm_control__node_DOT_py="def main(): pass",
    )
    package(tmp_path / "ws/src/build/copied", "copied")
    package(tmp_path / "ws/src/old", "old")
    write(tmp_path / "ws/src/old", COLCON_IGNORE="")
    return read(tmp_path / "ws/src")


def test_hidden_package_is_found_but_not_listed(tmp_path: Path) -> None:
    found = workspace(tmp_path)
    assert [(one.package.name, one.marker) for one in found.hidden] == [
        ("old", tmp_path / "ws/src/old/COLCON_IGNORE")
    ]  # markers in build output are not written by a person
    assert "old" not in {one.name for one in found.packages}
    for old in (found.package("old"), found.package_of(tmp_path / "ws/src/old/scripts/drive.py")):
        assert old is not None
        assert old.folder == tmp_path / "ws/src/old"
    assert found.package("elsewhere") is None


def test_visible_package_wins_over_a_hidden_one(tmp_path: Path) -> None:
    write(package(tmp_path / "a_fork", "arm"), CATKIN_IGNORE="")
    package(tmp_path / "arm", "arm")
    found = read(tmp_path)
    arm = found.package("arm")
    assert arm is not None
    assert (arm.folder, found.hidden) == (tmp_path / "arm", ())


def test_package_file_hides_it_first(tmp_path: Path) -> None:
    package(tmp_path / "arms/left", "left")
    write(tmp_path / "arms", CATKIN_IGNORE="")
    write(package(tmp_path / "arms/right", "right"), COLCON_IGNORE="")
    found = [(one.package.name, one.marker.name) for one in read(tmp_path).hidden]
    assert found == [("left", "CATKIN_IGNORE"), ("right", "COLCON_IGNORE")]


def test_a_workspace_lists_its_packages_programs_modules_and_files(tmp_path: Path) -> None:
    found = workspace(tmp_path)
    assert [one.name for one in found.packages] == ["arm_base", "arm_control"]
    base, control = found.packages
    assert [(one.name, one.path is not None) for one in base.executables] == [
        ("drive", True), ("gone.py", False), ("tune", True),
    ]  # fmt: skip
    assert [(one.name, one.path.name) for one in base.modules] == [("controllers", "controllers")]
    files = (base.interfaces, base.configurations, base.launch_files, base.parameter_files)
    assert [[one.name for one in some] for some in files] == [
        ["Reading.msg"],
        ["Arm.cfg"],
        ["arm.launch"],
        ["arm.yaml"],
    ]
    assert [(one.name, one.entry, one.path and one.path.name) for one in control.executables] == [
        ("control", "main", "node.py"), ("gone", "main", None),
    ]  # fmt: skip
    assert found.package_of(control.folder / "arm_control/node.py") == control
    assert [one.reason for one in found.problems()] == [
        "gone.py is installed, but its file gone.py does not exist",
        "gone is installed, but its file arm_control.gone does not exist",
    ]
