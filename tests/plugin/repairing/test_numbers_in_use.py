"""Of several numbers of a variable, a repair changes those that the missions of the test use, and names the others."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation, redefinition
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.repairing.placing import Placing
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Pair
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64, String


class Pilot:
    def __init__(self):
        self.speed = 1.0
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/mode", String, self.on_mode)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_mode(self, msg):
        if msg.data == "square":
            self.speed = 0.2
        else:
            self.speed = 0.4

    def on_value(self, msg):
        self.out.publish(self.speed * msg.data)


if __name__ == "__main__":
    rospy.init_node("pilot")
    Pilot()
    rospy.spin()
"""
SQUARE = 14


USE = 19


class Prepared:
    """The node with a change that doubles the speed where it is used; missions use the numbers of some lines."""

    def __init__(self, folder: Path, used: set[int], unrewarded: int = 0) -> None:
        (folder / "pilot.py").write_text(NODE)
        self.used, self.unrewarded, self.folder = used, unrewarded, folder
        self.analysis = analyse([folder], root=folder)
        (operand,) = {
            one
            for step in self.analysis.sites
            for one in self.analysis.operands(step.site)
            if one.code == "self.speed"
        }
        self.mutation = Mutation(operand, 2.0)
        order: Any = SimpleNamespace(
            goal=SimpleNamespace(pairs=tuple(Pair(seed, 0.0) for seed in range(3))),
            analysis=self.analysis,
            root=folder,
            options=SimpleNamespace(edit="auto"),
        )
        mutants: Any = SimpleNamespace(order=order, texts={})
        self.placing = Placing(mutants)

    def __call__(self, candidate: Candidate, _: int) -> Outcome:
        texts = rewrite(self.analysis, candidate.mutations, candidate.guard, {})
        lines = next(iter(texts.values()), NODE).splitlines()
        at_use = re.search(r"publish\((?:([\d.]+) \* )?self", lines[USE - 1])
        factor = float((at_use and at_use.group(1)) or 1.0)
        speeds = {line: factor * float(lines[line - 1].rpartition("= ")[2]) for line in self.used}
        earned = sum(speed for line, speed in speeds.items() if line != self.unrewarded)
        return Outcome(earned, True, outputs=(("/out", (sum(speeds.values()), 0.0)),))

    def equate(self, *_: Candidate) -> None:
        """Outcomes are not cached."""

    def moved(self, *mutations: Mutation) -> Candidate:
        found = self.placing(Candidate(mutations, ALWAYS), self)  # type: ignore[arg-type]
        assert found is not None
        return found

    def told(self, candidate: Candidate) -> list[str]:
        notes = [note.replace(f"{self.folder}/", "") for note in self.placing.notes(candidate)]
        return [note for note in notes if "stay unchanged" in note]


@pytest.mark.parametrize(
    ("used", "unrewarded", "expected"),
    [
        ({SQUARE}, 0, {SQUARE}),
        ({SQUARE, 16}, 0, {SQUARE, 16}),
        ({SQUARE, 16}, 16, {SQUARE, 16}),  # the second number alters what is published, not the reward
        ({7, 14, 16}, 0, {7, 14, 16}),
    ],
)
def test_only_used_numbers_are_changed(
    used: set[int], unrewarded: int, expected: set[int], tmp_path: Path
) -> None:
    world = Prepared(tmp_path, used, unrewarded)
    moved = world.moved(world.mutation)
    assert {one.place.line for one in moved.mutations if one.place} == expected
    left = ", ".join(f"pilot.py:{line}" for line in sorted({7, SQUARE, 16} - expected))
    note = (
        f"`self.speed` gets other numbers at {left}, which stay unchanged, because the missions of this test do not "
        "use them"
    )
    assert world.told(moved) == ([note] if left else [])


def test_changed_number_and_factor_become_one_change(tmp_path: Path) -> None:
    world = Prepared(tmp_path, {SQUARE})
    operand = world.mutation.operand
    (span,) = [one for one in operand.definitions if one.line == SQUARE]
    literal = replace(operand, span=span, code="0.2", value=0.2, definition=span, definitions=())
    moved = world.moved(Mutation(literal, 0.1), world.mutation)
    assert [(one.place.line, redefinition(one)) for one in moved.mutations if one.place] == [(SQUARE, 0.2)]
