"""Patches of several tests at the end of a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.patching.reading import read
from pytest_tarl.repairing.joining import joined
from tests.plugin.commands.test_applying import AGAIN, NODE, git, guarded, repair, robot
from tests.plugin.tank import ONLINE, RECORD

__all__ = ["robot"]


def test_one_alone_is_applied_as_it_is(robot: Path) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    found = joined([patch], robot)
    assert found.lines == ()
    assert found.commands == (f"git apply .tarl/patches/{patch.name}",)


def test_what_goes_together_becomes_one_patch_with_the_evidence_of_both(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("low = 1", "low = 3")}, "wind")
    found = joined([first, second], robot)
    (line,), (command,) = found.lines, found.commands
    assert line.startswith(f"{first.name} and {second.name} go together: .tarl/patches/combined-node-")
    git(*command.split()[1:], cwd=robot)
    assert (robot / "node.py").read_text() == guarded(NODE).replace("low = 1", "low = 3")
    combined = read(robot / command.split()[-1])
    assert combined.told("drift") == ["mud", "wind"]
    assert combined.told("again") == [AGAIN, AGAIN]


def test_a_conflict_is_told_with_its_lines_and_both_stay(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("GAIN * x", "0.4 * GAIN * x")}, "wind")
    found = joined([first, second], robot)
    assert found.lines[0].startswith(
        f"node.py:9 is changed in two ways, by {first.name} and by {second.name}: apply one"
    )
    assert len(found.commands) == 2


def test_the_same_change_is_applied_once(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": guarded(NODE)}, "wind")
    found = joined([first, second], robot)
    assert found.lines == (f"{second.name} makes the same change as {first.name}: one of them is enough",)
    assert found.commands == (f"git apply .tarl/patches/{first.name}",)


def test_what_would_not_compile_together_is_not_combined(robot: Path) -> None:
    first = repair(robot, {"node.py": NODE.replace("high = 2\n", "high = (2\n")})
    second = repair(robot, {"node.py": NODE.replace("GAIN = 5", "GAIN = 6")}, "wind")
    found = joined([first, second], robot)
    assert "are not combined: what they make together would not compile" in found.lines[0]
    assert sorted(path.name for path in robot.glob(".tarl/patches/*")) == sorted([first.name, second.name])


def test_a_run_ends_with_one_command_for_one_change(tank: pytest.Pytester) -> None:
    test = (tank.path / "test_tank.py").read_text()
    (tank.path / "test_twin.py").write_text(
        test[: test.index("def test_ordinary")].replace("test_fills", "test_twin")
    )
    tank.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    done = tank.runpytest(*ONLINE, "--tarl-repair")
    done.assert_outcomes(failed=2, deselected=1)
    assert len(list(tank.path.glob(".tarl/patches/*.patch"))) == 2
    commands = [line for line in done.outlines if line.startswith(("git apply", "patch -p1"))]
    told = [line for line in done.outlines if "one of them is enough" in line]
    assert len(commands) == len(told) == 1
