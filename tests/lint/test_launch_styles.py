"""Python launch files in the styles that people use: loops, comprehensions, classes, helper modules, files."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.name_resolution import joined
from tarl_lint.workspace.read import read

HEAD = """
import os
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition
from launch.substitutions import *
from launch_ros.actions import *
from ament_index_python.packages import get_package_share_directory, get_package_share_path
def talker(**given):
    return Node(package="demo", executable="talker", **given)
"""

STYLES = {
    "comprehension over pairs": (
        """
        robots = [("r1", 1.5), ("r2", 3.0)]
        def generate_launch_description():
            return LaunchDescription([talker(namespace=r, name=f"t{i:02d}", parameters=[{"rate": rate}])
                                      for i, (r, rate) in enumerate(robots)])
        """,
        {"/r1/t00": {"~rate": 1.5}, "/r2/t01": {"~rate": 3.0}},
    ),
    "generator and conditional expression": (
        """
        sim = True
        def nodes(prefix):
            yield talker(name=prefix + "_a")
            yield from [talker(name=prefix + "_b")]
        def generate_launch_description():
            return LaunchDescription([*nodes("x")] if sim else [])
        """,
        {"/x_a": {}, "/x_b": {}},
    ),
    "entities of another description": (
        """
        def part():
            return LaunchDescription([talker(name="inner")])
        def generate_launch_description():
            ld = LaunchDescription()
            for each in part().entities:
                ld.add_action(each)
            ld.add_entity(talker(name="outer"))
            return ld
        """,
        {"/inner": {}, "/outer": {}},
    ),
    "class": (
        """
        class Configured:
            NAME = "talker_x"
            def __init__(self, rate):
                self.rate = rate
            @property
            def full(self):
                return self.NAME + "_1"
            def node(self):
                return talker(name=self.full, parameters=[{"rate": self.rate}])
        class Faster(Configured):
            def __init__(self):
                super().__init__(9.0)
        def generate_launch_description():
            return LaunchDescription([Faster().node()])
        """,
        {"/talker_x_1": {"~rate": 9.0}},
    ),
    "data class and mapping": (
        """
        from dataclasses import dataclass, field
        @dataclass
        class Robot:
            name: str
            x: float = 0.5
            tags: list = field(default_factory=list)
        def generate_launch_description():
            robots = [Robot("a", 1.0), Robot(name="b")]
            where = {r.name: r.x for r in robots if not r.tags}
            return LaunchDescription([talker(name=f"d_{k}", parameters=[{"v": v}]) for k, v in sorted(where.items())])
        """,
        {"/d_a": {"~v": 1.0}, "/d_b": {"~v": 0.5}},
    ),
    "enumeration": (
        """
        from enum import Enum
        class Mode(Enum):
            SLOW = "slow"
            FAST = "fast"
        def generate_launch_description():
            return LaunchDescription([talker(name=mode.value) for mode in Mode] + [talker(name=Mode.FAST.name)])
        """,
        {"/slow": {}, "/fast": {}, "/FAST": {}},
    ),
    "while, lambda, map, match, walrus": (
        """
        def generate_launch_description():
            i, nodes = 0, []
            while i < 2:
                nodes.append(talker(name="w{}".format(i)))
                i += 1
            make = lambda name, **more: talker(name=name, **more)
            nodes += [make("l", namespace="/far")]
            nodes.extend(map(lambda k: make("m" + k), ["a"]))
            if (n := len(nodes)) > 3:
                nodes.append(make(f"n{n}"))
            match "m1":
                case "m0" | "m1":
                    nodes.append(make("matched"))
                case _:
                    nodes.append(make("other"))
            return LaunchDescription(nodes)
        """,
        {"/w0": {}, "/w1": {}, "/far/l": {}, "/ma": {}, "/n4": {}, "/matched": {}},
    ),
    "partial, keyword-only arguments, star targets": (
        """
        from functools import partial
        def made(name, *, rate=1.0, **more):
            return talker(name=name, parameters=[{"rate": rate}, more])
        def generate_launch_description():
            first, *rest = ["one", "two", "three"]
            quick = partial(made, rate=2.0)
            return LaunchDescription([quick(first, extra="y"), *[made(each) for each in rest]])
        """,
        {"/one": {"~rate": 2.0, "~extra": "y"}, "/two": {"~rate": 1.0}, "/three": {"~rate": 1.0}},
    ),
    "global, try, raise": (
        """
        count = 0
        def numbered():
            global count
            count += 1
            return f"g{count}"
        def generate_launch_description():
            nodes = [talker(name=numbered()), talker(name=numbered())]
            try:
                raise ValueError("no")
                nodes.append(talker(name="never"))
            except ValueError:
                nodes.append(talker(name="caught"))
            return LaunchDescription(nodes)
        """,
        {"/g1": {}, "/g2": {}, "/caught": {}},
    ),
    "files of the workspace": (
        """
        import yaml
        from pathlib import Path
        def generate_launch_description():
            share = get_package_share_path("demo")
            with open(os.path.join(get_package_share_directory("demo"), "config", "gate.yaml")) as file:
                rate = yaml.safe_load(file)["rate"]
            here = Path(__file__).resolve().parents[1] / "config"
            text, there = (share / "config" / "a.txt").read_text(), here.joinpath("b").exists()
            return LaunchDescription([
                talker(name="read", parameters=[{"rate": rate, "text": text, "there": there}])])
        """,
        {"/read": {"~rate": 4.5, "~text": "hello", "~there": False}},
    ),
    "files and folders of the package": (
        """
        import configparser, csv, glob, json
        def generate_launch_description():
            share = get_package_share_path("demo")
            names = sorted(p.stem for p in (share / "config").glob("*.yaml"))
            ini = configparser.ConfigParser()
            ini.read(str(share / "config" / "robot.ini"))
            with (share / "config" / "robots.csv").open() as file:
                rows = list(csv.DictReader(file))
            lines = [line.strip() for line in open(share / "config" / "a.txt")]
            try:
                absent = open(share / "config" / "absent.txt").read()
            except FileNotFoundError:
                absent = "nothing"
            return LaunchDescription([
                *[talker(name=row["name"], parameters=[{"rate": float(row["rate"])}]) for row in rows],
                talker(name="files", parameters=[{
                    "names": names, "lines": lines, "absent": absent, "speed": ini.getfloat("wheels", "speed"),
                    "side": ini["wheels"]["side"], "found": len(glob.glob(str(share / "config" / "r*.csv"))),
                    "listed": "robot.ini" in os.listdir(share / "config")}])])
        """,
        {
            "/c1": {"~rate": 1.5},
            "/c2": {"~rate": 2.0},
            "/files": {"~names": ["gate"], "~lines": ["hello"], "~absent": "nothing", "~speed": 0.5, "~side": "left",
                       "~found": 1, "~listed": True},
        },
    ),
    "context managers": (
        """
        from contextlib import contextmanager
        @contextmanager
        def inside(ld, name):
            actions = [PushRosNamespace(name)]
            try:
                yield actions
            finally:
                ld.add_action(GroupAction(actions))
        def generate_launch_description():
            ld = LaunchDescription()
            with inside(ld, "left") as left, inside(ld, "right") as right:
                left.append(talker(name="a"))
                right.append(talker(name="b"))
            return ld
        """,
        {"/left/a": {}, "/right/b": {}},
    ),
    "registry of decorated functions": (
        """
        from functools import wraps
        MAKERS = {}
        def maker(kind, **defaults):
            def decorator(function):
                @wraps(function)
                def wrapper(*args, **given):
                    return function(*args, **{**defaults, **given})
                MAKERS[kind] = wrapper
                return wrapper
            return decorator
        @maker("joy", rate=2.0)
        def joystick(name, rate):
            return talker(name=name, parameters=[{"rate": rate}])
        def generate_launch_description():
            return LaunchDescription([make(f"{kind}_{make.__name__}") for kind, make in MAKERS.items()])
        """,
        {"/joy_joystick": {"~rate": 2.0}},
    ),
    "objects with special methods": (
        """
        import re
        from enum import Flag, auto
        class Feature(Flag):
            NONE = 0
            SCAN = auto()
            ARM = auto()
        class Robot:
            def __init__(self, name, features=Feature.NONE):
                self.name, self.features = re.sub("[^a-z0-9]+", "_", name.lower()), features
            def __str__(self):
                return self.name
            def __format__(self, spec):
                return self.name.upper() if spec == "u" else str(self)
            def __lt__(self, other):
                return self.name < other.name
            def __iter__(self):
                yield talker(name=f"{self}", parameters=[{"label": f"{self:u}"}])
                if Feature.ARM in self.features:
                    yield talker(name=f"{self!s}_arm")
        def generate_launch_description():
            robots = [Robot("B 2", Feature.SCAN), Robot("a-1", Feature.SCAN | Feature.ARM)]
            return LaunchDescription([node for robot in sorted(robots) for node in robot])
        """,
        {"/a_1": {"~label": "A_1"}, "/a_1_arm": {}, "/b_2": {"~label": "B_2"}},
    ),
    "containers as parameters": (
        """
        from collections import ChainMap, Counter, deque, namedtuple
        from itertools import chain, count
        Point = namedtuple("Point", "x y", defaults=[0.5])
        def generate_launch_description():
            kinds = Counter(["scan", "arm", "scan"])
            return LaunchDescription(talker(name=name, parameters=[ChainMap({"rate": n}, {"rate": 9, "at": Point(1.5)}),
                                                                   {"last": deque([1, 2, 3], maxlen=2)}])
                                     for n, (name, _) in zip(count(1), kinds.most_common()))
        """,
        {
            "/scan": {"~at": [1.5, 0.5], "~rate": 1, "~last": [2, 3]},
            "/arm": {"~at": [1.5, 0.5], "~rate": 2, "~last": [2, 3]},
        },
    ),
    "function of an OpaqueFunction": (
        """
        from launch.utilities import perform_substitutions
        def setup(context, suffix):
            ns = perform_substitutions(context, [LaunchConfiguration("ns")])
            robots = LaunchConfiguration("robots").perform(context).split(",")
            nodes = [talker(namespace=os.path.join(ns, each.strip()), name="t" + suffix) for each in robots]
            if IfCondition(LaunchConfiguration("sim")).evaluate(context):
                nodes.append(talker(name="simulated"))
            return [GroupAction(nodes)]
        def generate_launch_description():
            return LaunchDescription([
                DeclareLaunchArgument("ns", default_value="fleet"),
                DeclareLaunchArgument("robots", default_value="a, b"),
                DeclareLaunchArgument("sim", default_value="true"), OpaqueFunction(function=setup, args=["_x"])])
        """,
        {"/fleet/a/t_x": {}, "/fleet/b/t_x": {}, "/simulated": {}},
    ),
    "module of the package": (
        """
        from demo.nodes import made, NAMES
        def generate_launch_description():
            return LaunchDescription([made(name) for name in NAMES])
        """,
        {"/h1": {}, "/h2": {}},
    ),
    "module beside the launch file": (
        """
        import helper
        def generate_launch_description():
            return LaunchDescription([talker(name=helper.name_of(3))])
        """,
        {"/n3": {}},
    ),
    "arguments for ROS": (
        """
        def generate_launch_description():
            return LaunchDescription([talker(name="n", arguments=["--ros-args", "-p", "rate:=9.5"],
                                             ros_arguments=["-r", "in:=inn"], remappings=[("in", "later")])])
        """,
        {"/n": {"~rate": 9.5}},
    ),
}  # fmt: skip


def launched(tmp_path: Path, text: str) -> Launch:
    """Return a launch file in a package with helper modules and files."""
    pytest.importorskip("yaml")
    files = {
        "package.xml": "<package><name>demo</name><export><build_type>ament_python</build_type></export></package>",
        "setup.py": "from setuptools import setup\nsetup(packages=['demo'])\n",
        "demo/__init__.py": "",
        "demo/nodes.py": "from launch_ros.actions import Node\nNAMES = ['h1', 'h2']\n"
        "def made(name):\n    return Node(package='demo', executable='talker', name=name)\n",
        "launch/helper.py": "def name_of(number):\n    return f'n{number}'\n",
        "config/gate.yaml": "rate: 4.5\n",
        "config/a.txt": "hello",
        "config/robot.ini": "[wheels]\nspeed = 0.5\nside = left\n",
        "config/robots.csv": "name,rate\nc1,1.5\nc2,2\n",
        "launch/x.launch.py": HEAD + dedent(text),
    }
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    return read_launch(tmp_path / "launch" / "x.launch.py", read(tmp_path))


def private(node: LaunchedNode) -> dict[str, object]:
    import yaml

    return {one.name: one.value if one.yaml is None else yaml.safe_load(one.yaml) for one in node.settings}


@pytest.mark.parametrize("style", STYLES)
def test_python_launch_styles_are_understood(tmp_path: Path, style: str) -> None:
    text, expected = STYLES[style]
    found = launched(tmp_path, text)
    assert not found.problems
    assert {joined(one.namespace, one.name): private(one) for one in found.nodes} == expected


def test_a_submodule_of_an_imported_package_is_read(tmp_path: Path) -> None:
    text = """
        import demo.nodes
        def setup(context):
            kind = "list" if type(demo.nodes.NAMES) == list else "other"
            return [demo.nodes.made(kind)]
        def generate_launch_description():
            return LaunchDescription([OpaqueFunction(function=setup)])
        """
    (node,) = launched(tmp_path, text).nodes
    assert node.name == "list"
    assert "demo.nodes.made(kind)" in (HEAD + dedent(text)).splitlines()[node.line - 1]


def test_file_named_like_a_library_does_not_replace_it(tmp_path: Path) -> None:
    (tmp_path / "launch").mkdir()
    for name in ("launch", "os", "launch_ros"):
        (tmp_path / "launch" / f"{name}.py").write_text("raise SystemExit\n")
    found = launched(tmp_path, STYLES["function of an OpaqueFunction"][0])
    assert not found.problems
    assert len(found.nodes) == 3


def test_arguments_that_a_function_reads_are_known(tmp_path: Path) -> None:
    text = """
        def setup(context):
            configured = context.launch_configurations
            return [talker(name=configured.get("first", "a") + configured["second"])]
        def generate_launch_description():
            return LaunchDescription([SetLaunchConfiguration("second", "b"), OpaqueFunction(function=setup)])
        """
    found = launched(tmp_path, text)
    assert found.arguments == ("first", "second")
    assert [one.name for one in found.nodes] == ["ab"]


def test_file_with_generate_launch_description_is_a_launch_file(tmp_path: Path) -> None:
    launched(tmp_path, STYLES["generator and conditional expression"][0])
    (tmp_path / "launch/robot.py").write_text("def generate_launch_description():\n    pass\n")
    (package,) = read(tmp_path).packages
    assert [one.name for one in package.launch_files] == ["robot.py", "x.launch.py"]


def test_arguments_of_a_node_remap_its_topics(tmp_path: Path) -> None:
    (node,) = launched(tmp_path, STYLES["arguments for ROS"][0]).nodes
    assert node.remaps == (("in", "inn"),)


def test_node_line_is_in_the_launch_file(tmp_path: Path) -> None:
    found = launched(tmp_path, STYLES["module of the package"][0])
    lines = (HEAD + dedent(STYLES["module of the package"][0])).splitlines()
    assert all("made(name)" in lines[one.line - 1] for one in found.nodes)


def test_known_nodes_beside_unknown_ones_are_found(tmp_path: Path) -> None:
    text = """
        from robots_that_are_not_installed import nodes
        def generate_launch_description():
            return LaunchDescription(nodes() + [talker(name="a")] + [*nodes(), talker(name="b")])
        """
    found = launched(tmp_path, text)
    assert [one.name for one in found.nodes] == ["a", "b"]
    assert {one.reason for one in found.problems} == {"`nodes()` is not followed"}


def test_the_items_of_a_dict_can_be_remappings(tmp_path: Path) -> None:
    text = """
        def generate_launch_description():
            names = {"in": "/scan", "out": "/cmd"}
            return LaunchDescription([talker(name="n", remappings={k: v for k, v in names.items()}.items())])
        """
    (node,) = launched(tmp_path, text).nodes
    assert node.remaps == (("in", "/scan"), ("out", "/cmd"))


def test_launch_file_data_changes_do_not_affect_later_files(
    tmp_path: Path,
) -> None:
    text = """
        import yaml
        def generate_launch_description():
            with open(os.path.join(get_package_share_directory("demo"), "config", "gate.yaml")) as file:
                config = yaml.safe_load(file)
            config["rate"] += 1
            return LaunchDescription([talker(name="n", parameters=[config])])
        """
    for _ in range(2):
        (node,) = launched(tmp_path, text).nodes
        assert private(node) == {"~rate": 5.5}


def test_folders_outside_the_workspace_are_not_listed(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("")
    text = f"""
        from pathlib import Path
        def generate_launch_description():
            names = [p.name for p in Path("{tmp_path}").glob("*")]
            return LaunchDescription([talker(name="n", parameters=[{{"names": names}}])])
        """
    (tmp_path / "inside").mkdir()
    found = launched(tmp_path / "inside", text)
    assert "secret" not in repr(found.nodes)
    assert [one.reason for one in found.problems] == ["the parameter names is not constant"]


def test_files_outside_the_workspace_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    text = f"""
        def generate_launch_description():
            with open("{tmp_path}/secret.txt") as file:
                text = file.read()
            return LaunchDescription([talker(name="n", parameters=[{{"text": text}}])])
        """
    (tmp_path / "inside").mkdir()
    found = launched(tmp_path / "inside", text)
    assert "secret" not in repr(found.nodes)
    assert [one.reason for one in found.problems] == ["the parameter text is not constant"]
