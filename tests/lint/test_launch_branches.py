"""Both branches of an `if` in a Python launch file whose condition is known only on the robot."""

import itertools
from pathlib import Path
from textwrap import dedent, indent

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from tarl_lint.workspace.launch_model import Launch
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.model import Workspace

HEAD = """\
import os
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetLaunchConfiguration
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap

REAL = "REAL" in os.environ


def node(name, **more):
    return Node(package="demo", executable="talk", name=name, **more)


"""


def launched(folder: Path, text: str) -> Launch:
    """Return the contents of a launch file."""
    file = folder / "x.launch.py"
    file.write_text(HEAD + dedent(text))
    return read_launch(file, Workspace(folder))


def conditions(found: Launch) -> dict[str, str]:
    """Return the condition of each node, by the name of the node."""
    return {one.name: one.condition for one in found.nodes}


def described(folder: Path, statements: str, description: str) -> Launch:
    """Return the contents of a launch file with these statements before the description is returned."""
    body = indent(dedent(statements), "    ")
    return launched(folder, f"def generate_launch_description():\n{body}\n    return {description}\n")


CASES = {
    "added": (
        """
        found = LaunchDescription([node("both")])
        if REAL:
            found.add_action(node("real"))
        else:
            found.add_action(node("sim"))
        found.add_action(node("last"))
        """,
        "found",
        {"both": "", "real": "REAL", "sim": "not REAL", "last": ""},
    ),
    "made before": (
        """
        found, real = [node("both")], node("real")
        if REAL:
            found.append(real)
        """,
        "LaunchDescription(found)",
        {"both": "", "real": "REAL"},
    ),
    "variable": (
        """
        driver = None
        if REAL:
            driver = node("real")
        elif os.path.exists("/dev/can0"):
            driver = node("can")
        """,
        'LaunchDescription([driver, node("both")])',
        {"real": "REAL", "can": "not REAL and os.path.exists('/dev/can0')", "both": ""},
    ),
    "lists": (
        """
        both = node("both")
        if REAL:
            found = [both, node("real")]
        else:
            found = [both]
            found += [node("sim")]
        """,
        "LaunchDescription(found)",
        {"both": "", "real": "REAL", "sim": "not REAL"},
    ),
    "expression": (
        "",
        'LaunchDescription([node("real") if REAL else node("sim"), *([node("more")] if REAL else [])])',
        {"real": "REAL", "sim": "not REAL", "more": "REAL"},
    ),
    "continue": (
        """
        found = []
        for name in "ab":
            if name == "a" and REAL:
                continue
            found.append(node(name))
        """,
        "LaunchDescription(found)",
        {"a": "not (name == 'a' and REAL)", "b": ""},
    ),
    "break": (
        """
        found = []
        for name in "ab":
            found.append(node(name))
            if REAL:
                break
        found.append(node("last"))
        """,
        "LaunchDescription(found)",
        {"a": "", "b": "not REAL", "last": ""},
    ),
    "match": (
        """
        found = []
        match os.environ["ROBOT"]:
            case "a":
                found.append(node("a"))
            case _:
                found.append(node("other"))
        """,
        "LaunchDescription(found)",
        {"a": "os.environ['ROBOT'] == 'a'", "other": "os.environ['ROBOT'] != 'a'"},
    ),
    "raise": (
        """
        if not os.path.exists("/etc/robot"):
            raise RuntimeError("no robot")
        """,
        'LaunchDescription([node("a")])',
        {"a": ""},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_nodes_of_both_branches_are_read_as_conditional(tmp_path: Path, name: str) -> None:
    statements, description, expected = CASES[name]
    assert conditions(described(tmp_path, statements, description)) == expected


def test_nodes_of_each_return_statement_are_read(tmp_path: Path) -> None:
    text = """
        def setup(context):
            mode = LaunchConfiguration("mode").perform(context)
            shared = node("shared")
            if mode == "real":
                return [shared, node("real")]
            elif mode == "sim":
                return [shared, node("sim")]
            return [shared]

        def generate_launch_description():
            return LaunchDescription([OpaqueFunction(function=setup)])
        """
    found = launched(tmp_path, text)
    assert conditions(found) == {
        "shared": "",
        "real": "mode == 'real'",
        "sim": "mode != 'real' and mode == 'sim'",
    }


def test_a_value_that_differs_between_the_branches_is_symbolic(tmp_path: Path) -> None:
    statements = """
        remaps, values = [("same", "same")], {"rate": 5}
        if REAL:
            topic, same = "scan", 1
            remaps.append(("raw", "image"))
            values["gain"] = 1.0
        else:
            topic, same = "gazebo/scan", 1
            values["rate"] = 6
        """
    made = 'node("a", remappings=[("in", topic), *remaps], parameters=[values, {"same": same}])'
    (found,) = described(tmp_path, statements, f"LaunchDescription([{made}])").nodes
    assert found.remaps == (
        ("in", "$('scan' if REAL else 'gazebo/scan')"),
        ("same", "same"),
        ("raw", "$('image' if REAL)"),
    )
    assert {one.name: one.value for one in found.settings} == {"~rate": None, "~gain": None, "~same": 1}
    assert found.condition == ""


def test_values_of_a_branch_are_known_in_this_branch(tmp_path: Path) -> None:
    statements = """
        found = []
        if REAL:
            values = {}
            values["gain"] = 1.0
            found.append(node("real", parameters=[values]))
        """
    (found,) = described(tmp_path, statements, "LaunchDescription(found)").nodes
    assert [(one.name, one.value) for one in found.settings] == [("~gain", 1.0)]


def test_settings_of_one_branch_are_symbolic_afterwards(tmp_path: Path) -> None:
    statements = """
        found = []
        if REAL:
            found += [PushRosNamespace("real"), SetRemap("a", "b"), SetLaunchConfiguration("c", "d")]
            found += [SetParameter("p", 1), DeclareLaunchArgument("e", default_value="f")]
        else:
            found += [DeclareLaunchArgument("e", default_value="g")]
        found.append(node(LaunchConfiguration("c"), remappings=[("x", LaunchConfiguration("e"))]))
        """
    (found,) = described(tmp_path, statements, "LaunchDescription(found)").nodes
    assert found.remaps == (("a", "$(b if REAL)"), ("x", "$(var e)"))
    assert (found.name, found.namespace) == ("$(var c)", "/$(real if REAL)")
    assert [(one.name, one.unknown) for one in found.settings] == [("~p", True)]


def test_functions_that_differ_between_the_branches_are_called(tmp_path: Path) -> None:
    statements = """
        if REAL:
            def made():
                return node("real")
        else:
            def made():
                return node("sim")
        """
    assert [one.name for one in described(tmp_path, statements, "LaunchDescription([made()])").nodes] == [
        "real"
    ]


def test_an_unknown_condition_is_reported(tmp_path: Path) -> None:
    statements = """
        found = []
        if REAL:
            found.append(node("a"))
        if REAL:
            pass
        else:
            found.append(node("b"))
        """
    found = described(tmp_path, statements, "LaunchDescription(found)")
    assert [one.reason.partition("is not constant")[2] for one in found.problems] == [
        "",
        "; both branches are read",
    ]


Statements = list[tuple[object, ...]]
MOST = 5  # maximum number of conditions of a launch file; the oracle reads the file for all their values


def blocks(depth: int, *, loop: bool) -> st.SearchStrategy[Statements]:
    """Return a strategy for statements of a launch file. Loops contain no loops."""
    simple = ["append", "add", "augment", "driver", "no driver", "return"] + ["break", "continue"] * loop
    one: st.SearchStrategy[tuple[object, ...]] = st.sampled_from([(kind,) for kind in simple])
    if depth:
        inner = blocks(depth - 1, loop=loop)
        one |= st.tuples(st.just("if"), inner, inner | st.just([]))
        if not loop:
            one |= st.tuples(st.just("for"), blocks(depth - 1, loop=True))
    return st.lists(one, min_size=1, max_size=3)


class Writer:
    """Writes statements with unknown conditions. In a loop, each iteration has conditions of its own."""

    def __init__(self) -> None:
        self.numbers = itertools.count()
        self.conditions: list[str] = []

    def written(self, block: Statements, turns: str = "0") -> str:
        """Return the source; `turns` are the values of `turn` there."""
        return "\n".join(self.statement(one, turns) for one in block)

    def statement(self, statement: tuple[object, ...], turns: str) -> str:
        """Return the source of one statement."""
        kind, *inner = statement
        blocks = [one for one in inner if isinstance(one, list)]
        number = next(self.numbers)
        if kind == "if":
            self.conditions += [f"c{number}_{turn}" for turn in turns]
            body, other = (indent(self.written(one, turns), "    ") for one in blocks)
            return f'if f"c{number}_{{turn}}" in KNOWN:\n{body}' + (f"\nelse:\n{other}" if other else "")
        if kind == "for":
            return f"for turn in (1, 2):\n{indent(self.written(blocks[0], '12'), '    ')}\nturn = 0"
        made = f'node(f"n{number}_{{turn}}")'
        return {
            "append": f"found.append({made})",
            "add": f"whole.add_action({made})",
            "augment": f"found += [{made}]",
            "driver": f"driver = {made}",
            "no driver": "driver = None",
            "return": f"return LaunchDescription([*found, driver, whole, {made}])",
        }.get(str(kind), str(kind))


@given(block=blocks(2, loop=False))
@example([("for", [("if", [("break",)], [("driver",)])])])
@example([("for", [("if", [("return",)], [("break",)])]), ("append",)])
@example([("for", [("if", [("continue",)], []), ("return",)])])
@example([("for", [("if", [("continue",)], []), ("break",)]), ("append",)])
@example([("for", [("if", [("break",)], []), ("append",), ("return",)]), ("append",)])
def test_the_nodes_of_all_branches_are_found(
    tmp_path_factory: pytest.TempPathFactory, block: Statements
) -> None:
    folder, writer = tmp_path_factory.mktemp("w"), Writer()
    body = writer.written(block)
    assume(len(writer.conditions) <= MOST)

    def read(known: str) -> dict[str, str]:
        start = "found, whole, driver, turn = [], LaunchDescription([]), None, 0\n"
        text = f"KNOWN = {known}\n{start}{body}\n"
        return conditions(described(folder, text, "LaunchDescription([*found, driver, whole])"))

    found = read("os.environ")
    several = [
        set(read(repr([one for one, holds in zip(writer.conditions, values, strict=True) if holds])))
        for values in itertools.product((True, False), repeat=len(writer.conditions))
    ]
    assert set(found) == set.union(*several)
    assert {name for name, condition in found.items() if not condition} <= set.intersection(*several)
