"""Merging the patches of several tests at the end of a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.patching.patch_reader import read
from pytest_tarl.repairing.merge_patches import joined
from tests.plugin.commands.test_applying import AGAIN, NODE, git, guarded, repair, robot
from tests.plugin.tank import ONLINE, RECORD

__all__ = ["robot"]


def test_a_single_patch_is_applied_unchanged(robot: Path) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    found = joined([patch], robot)
    assert found.lines == ()
    assert found.commands == (f"git apply .tarl/patches/{patch.name}",)


def test_merged_patches_keep_both_evidence(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("low = 1", "low = 3")}, "wind")
    found = joined([first, second], robot)
    (line,), (command,) = found.lines, found.commands
    assert line.startswith(f"{first.name} and {second.name} do not conflict: .tarl/patches/combined-node-")
    git(*command.split()[1:], cwd=robot)
    assert (robot / "node.py").read_text() == guarded(NODE).replace("low = 1", "low = 3")
    combined = read(robot / command.split()[-1])
    assert combined.told("drift") == ["mud", "wind"]
    assert combined.told("again") == [AGAIN, AGAIN]
    header = combined.path.read_text().partition("\ndiff --git")[0]
    words = ["part " + first.name, "drift: mud", "part " + second.name, "drift: wind"]
    found_at = [header.index(word) for word in words]  # positions of the two sections of evidence
    assert found_at == sorted(found_at)


def test_conflict_is_reported_and_both_patches_stay(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("GAIN * x", "0.4 * GAIN * x")}, "wind")
    found = joined([first, second], robot)
    assert found.lines[0].startswith(
        f"node.py:9 is changed in two ways, by {first.name} and by {second.name}: apply one"
    )
    assert len(found.commands) == 2


@pytest.mark.parametrize("other", ["node.py", "user.py"])
def test_definition_and_use_changes_conflict(robot: Path, other: str) -> None:
    (robot / "user.py").write_text(NODE.replace("GAIN = 5", "from node import GAIN"))
    git("add", "-A", cwd=robot)
    git("commit", "-qm", "another module uses it", cwd=robot)
    constant = ("constant: node.py:3 column 8",)
    first = repair(robot, {"node.py": NODE.replace("GAIN = 5", "GAIN = 7")}, "worn", constant)
    second = repair(robot, {other: guarded((robot / other).read_text())}, "mud", constant)
    third = repair(
        robot, {other: guarded((robot / other).read_text())}, "wind", ("constant: node.py:4 column 7",)
    )
    found = joined([first, second], robot)
    told = f"node.py:3 is changed in two ways, by {first.name} and by {second.name}: apply one"
    assert found.lines[0].startswith(told)
    assert len(found.commands) == 2
    assert "changed in two ways" not in "".join(joined([first, third], robot).lines)


BOTH = "from std_msgs.msg import Bool, Float32, Float64"
IMPORTING = NODE.replace("import rospy\n", "import rospy\nfrom std_msgs.msg import Float64\n")


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_names_added_to_one_import_are_merged(robot: Path, ending: str) -> None:
    (robot / "node.py").write_bytes(IMPORTING.replace("\n", ending).encode())
    git("commit", "-qam", "it imports", cwd=robot)
    bool_too = IMPORTING.replace("import Float64", "import Bool, Float64").replace("low = 1", "low = 3")
    float_too = IMPORTING.replace("import Float64", "import Float32, Float64").replace("GAIN = 5", "GAIN = 7")
    first, second = repair(robot, {"node.py": bool_too}), repair(robot, {"node.py": float_too}, "wind")
    found = joined([first, second], robot)
    assert "do not conflict" in found.lines[0]
    git(*found.commands[0].split()[1:], cwd=robot)
    wanted = IMPORTING.replace("from std_msgs.msg import Float64", BOTH)
    wanted = wanted.replace("low = 1", "low = 3").replace("GAIN = 5", "GAIN = 7")
    assert (robot / "node.py").read_bytes() == wanted.replace("\n", ending).encode()


def test_a_merged_patch_is_reverted_as_a_whole(robot: Path) -> None:
    (robot / "node.py").write_text(IMPORTING)
    git("commit", "-qam", "it imports", cwd=robot)
    added = "from nav_msgs.msg import Odometry\nfrom std_msgs.msg import Bool, Float64"
    first = repair(robot, {"node.py": IMPORTING.replace("from std_msgs.msg import Float64", added)})
    second = repair(
        robot, {"node.py": IMPORTING.replace("import Float64", "import Float32, Float64")}, "wind"
    )
    assert main(["apply", str(first), str(second)]) == 0
    both = (robot / "node.py").read_text()
    assert f"from nav_msgs.msg import Odometry\n{BOTH}\n" in both
    assert main(["revert", str(first), str(second)]) == 0
    assert (robot / "node.py").read_text() == IMPORTING


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("from std_msgs.msg import Bool, Float64", "from std_msgs.msg import Float64 as Number"),
        ("from std_msgs.msg import Bool, Float64  # told", "from std_msgs.msg import Float32, Float64"),
        ("GAIN = 2", "from std_msgs.msg import Float32, Float64"),
    ],
)
def test_lines_that_lose_an_import_or_a_comment_conflict(robot: Path, one: str, other: str) -> None:
    (robot / "node.py").write_text(IMPORTING)
    git("commit", "-qam", "it imports", cwd=robot)
    first, second = (
        repair(robot, {"node.py": IMPORTING.replace("from std_msgs.msg import Float64", text)}, drift)
        for text, drift in ((one, "mud"), (other, "wind"))
    )
    assert "node.py:2 is changed in two ways" in joined([first, second], robot).lines[0]


def test_an_insertion_that_another_insertion_contains_is_added_once(robot: Path) -> None:
    first = repair(robot, {"node.py": NODE.replace("low = 1\n", "low = 1\nterrain = None\n")})
    more = NODE.replace("low = 1\n", "low = 1\nterrain = None\nrain = None\n").replace("GAIN = 5", "GAIN = 6")
    second = repair(robot, {"node.py": more}, "wind")
    found = joined([first, second], robot)
    git(*found.commands[0].split()[1:], cwd=robot)
    assert (robot / "node.py").read_text() == more


def test_equal_changes_are_applied_once(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": guarded(NODE)}, "wind")
    found = joined([first, second], robot)
    assert found.lines == (f"{second.name} makes the same change as {first.name}: apply only one of them",)
    assert found.commands == (f"git apply .tarl/patches/{first.name}",)


def test_patches_that_do_not_compile_together_are_not_merged(robot: Path) -> None:
    first = repair(robot, {"node.py": NODE.replace("high = 2\n", "high = (2\n")})
    second = repair(robot, {"node.py": NODE.replace("GAIN = 5", "GAIN = 6")}, "wind")
    found = joined([first, second], robot)
    assert "cannot be merged: the merged file does not compile" in found.lines[0]
    assert sorted(path.name for path in robot.glob(".tarl/patches/*")) == sorted([first.name, second.name])


@pytest.mark.usefixtures("quick_acceptance")
def test_patches_of_a_parameter_file_are_merged(robot: Path) -> None:
    text = "keeper:\n  gain: 2.0\n  high: 1\n  wide: 2\n  far: 3\n  offset: 0.0\n"
    (robot / "params.yaml").write_text(text)
    git("add", "-A", cwd=robot)
    git("commit", "-qm", "parameters", cwd=robot)
    changes = (("gain: 2.0", "gain: 3.0", "mud"), ("offset: 0.0", "offset: 0.1", "wind"))
    patches = [repair(robot, {"params.yaml": text.replace(old, new)}, drift) for old, new, drift in changes]
    (command,) = joined(patches, robot).commands
    git(*command.split()[1:], cwd=robot)
    assert (robot / "params.yaml").read_text() == text.replace("2.0", "3.0").replace("0.0", "0.1")


def test_run_with_one_change_ends_with_one_command(tank: pytest.Pytester) -> None:
    test = (tank.path / "test_tank.py").read_text()
    (tank.path / "test_twin.py").write_text(
        test[: test.index("def test_ordinary")].replace("test_fills", "test_twin")
    )
    tank.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    done = tank.runpytest(*ONLINE, "--tarl-repair")
    done.assert_outcomes(failed=2, deselected=1)
    assert len(list(tank.path.glob(".tarl/patches/*.patch"))) == 2
    commands = [line for line in done.outlines if line.startswith(("git apply", "patch -p1"))]
    told = [line for line in done.outlines if "only one of them" in line]
    assert len(commands) == len(told) == 1
