"""Of several numbers of a variable, a repair changes those that the missions of the test use, and names the others."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation, redefinition
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


@pytest.mark.parametrize(
    ("used", "by_outputs", "expected"),
    [
        ({SQUARE}, False, {SQUARE}),
        ({SQUARE, 16}, False, {SQUARE, 16}),
        ({SQUARE, 16}, True, {SQUARE, 16}),  # the second number alters what is published, not the reward
        ({7, 14, 16}, False, {7, 14, 16}),
    ],
)
def test_only_numbers_that_take_part_in_the_missions_are_changed(
    used: set[int], by_outputs: bool, expected: set[int], tmp_path: Path
) -> None:
    (tmp_path / "pilot.py").write_text(NODE)
    analysis = analyse([tmp_path], root=tmp_path)
    (operand,) = {
        one for step in analysis.sites for one in analysis.operands(step.site) if one.code == "self.speed"
    }
    mutation = Mutation(operand, 2.0)

    def trials(candidate: Candidate, _: int) -> Outcome:
        changed = {
            one.place.line: float(redefinition(one))
            for one in candidate.mutations
            if one.place is not None and one.place.line in used
        }
        at_use = any(one.place is None for one in candidate.mutations)
        doubled = used if at_use else changed.keys()
        earned = len(doubled - {16}) if by_outputs else len(doubled)
        return Outcome(float(earned), True, outputs=(("/out", (float(len(doubled)), 0.0)),))

    run: Any = trials
    order: Any = SimpleNamespace(
        goal=SimpleNamespace(pairs=tuple(Pair(seed, 0.0) for seed in range(3))),
        analysis=analysis,
        root=tmp_path,
        options=SimpleNamespace(edit="auto"),
    )
    mutants: Any = SimpleNamespace(order=order, texts={})
    placing = Placing(mutants)
    run.equate = lambda *_: None
    moved = placing(Candidate((mutation,), ALWAYS), run)
    assert moved is not None
    assert {one.place.line for one in moved.mutations if one.place} == expected
    told = [note.replace(f"{tmp_path}/", "") for note in placing.notes(moved) if "stay unchanged" in note]
    left = ", ".join(f"pilot.py:{line}" for line in sorted({7, SQUARE, 16} - expected))
    note = (
        f"`self.speed` gets other numbers at {left}, which stay unchanged, because the missions of this test do not "
        "use them"
    )
    assert told == ([note] if left else [])
