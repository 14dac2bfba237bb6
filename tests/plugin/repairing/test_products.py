"""A search moves one constant of each product, because a factor on any of them gives the same program."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.repairing import products
from pytest_tarl.repairing.products import one_of_each
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64

GAIN, MASS, LIMIT, COUNT = 2.0, 3.0, 0.8, 3


class Keeper:
    def __init__(self):
        self.kp = 1.5
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_in)

    def on_in(self, msg):
        self.out.publish({use})


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("use", "same"),
    [
        ("GAIN * MASS * msg.data", ["MASS"]),
        ("-(GAIN * (msg.data * MASS)) * 9.81", ["MASS", "9.81"]),
        ("GAIN * msg.data / MASS", []),
        ("GAIN / MASS * self.kp * msg.data", ["self.kp"]),
        ("GAIN * msg.data + MASS * msg.data", []),
        ("GAIN * (msg.data + MASS)", []),
        ("GAIN * (MASS * msg.data + LIMIT * 0.5)", ["0.5"]),
        ("GAIN * max(-LIMIT, min(LIMIT, msg.data))", []),
        ("GAIN * abs(MASS * msg.data)", []),
        ("0.0 * GAIN + msg.data * 0.0", []),
    ],
)
def test_one_factor_represents_its_product(use: str, same: list[str], tmp_path: Path) -> None:
    path = tmp_path / "keeper.py"
    path.write_text(NODE.format(use=use))
    analysis = analyse([path], root=tmp_path)
    operands = list(dict.fromkeys(o for step in analysis.sites for o in analysis.operands(step.site)))
    operands.sort(key=lambda one: (one.literal, one.span))
    kept, others = one_of_each(analysis, operands)
    assert [one.code for one in others] == same
    assert sorted(map(id, [*kept, *others])) == sorted(map(id, operands))


MADE_LATE = """\
import rospy
from std_msgs.msg import Float64


class Spiral:
    def __init__(self, pitch, most, name_only):
        self.pitch = pitch
        self.most = most
        self.name_only = name_only
        self.angle = 0.0

    def reach(self, by):
        self.angle += by
        return min(self.pitch * self.angle, self.most)


class Keeper:
    def __init__(self):
        self.spiral = None
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_in)

    def on_in(self, msg):
        if msg.data > 1.0:
            self.spiral = Spiral(0.5, 4.0, 7.0)
        self.out.publish(self.spiral.reach(msg.data))
"""


def test_use_of_a_stored_constant_is_searched(tmp_path: Path) -> None:
    path = tmp_path / "keeper.py"
    path.write_text(MADE_LATE)
    analysis = analyse([path], root=tmp_path)
    operands = list(dict.fromkeys(o for step in analysis.sites for o in analysis.operands(step.site)))
    kept, same = one_of_each(analysis, operands)
    stored = [one for one in operands if one.site.qualname == "Spiral.__init__" and not one.literal]
    used = [one.code for one in kept if one.site.qualname == "Spiral.reach"]
    assert {one.code for one in stored} >= {"pitch", "most"}
    assert {one.code for one in same} == {"pitch", "most"}
    assert {"self.pitch", "self.most"} <= set(used)


@dataclass(frozen=True)
class Use:
    """A constant of a statement, and the expression that contains it."""

    code: str
    definition: str | None = None
    stored: bool = False
    product: str | None = None
    site: str = "site"
    value: float = 1.0


@pytest.mark.parametrize(
    ("operands", "kept"),
    [
        ([Use("limit", "d", stored=True), Use("self.limit", "d")], "self.limit"),
        ([Use("self.limit", "d"), Use("limit", "d", stored=True)], "self.limit"),
        ([Use("limit", "d", stored=True), Use("self.other", "e")], "limit self.other"),
        ([Use("limit", "d", stored=True)], "limit"),
        ([Use("a", stored=True), Use("b")], "a b"),  # neither has a definition
        ([Use("a", product="p"), Use("b", product="p"), Use("c", product="q")], "a c"),
        ([Use("a", product="p"), Use("a", product="p"), Use("b", product="p")], "a a b"),  # used twice
    ],
)
def test_equivalent_constant_is_not_searched(
    operands: list[Use], kept: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(products, "_stored", lambda _, one: one.stored)
    monkeypatch.setattr(products, "_product", lambda _, one: one.product)
    some: Any = operands
    analysis: Any = None
    found, same = one_of_each(analysis, some)
    assert " ".join(one.code for one in found) == kept
    assert len(found) + len(same) == len(operands)
