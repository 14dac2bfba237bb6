"""The check for lost lines before a patch is written."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.verify import nothing_lost

NODE = """\
# how far, how fast
GAIN = 5  # 1/s


def drive(delta, pub):
    err = abs(delta); ok = err < 1
    # towards the goal
    vel = GAIN * delta
    if ok:  # nearly there
        pub.publish(vel)
"""


def test_a_conditional_change_keeps_all_statements_and_comments() -> None:
    patched = NODE.replace(
        "    vel = GAIN * delta\n",
        "    if wet:\n        vel = 2.2 * GAIN * delta\n    else:\n        vel = GAIN * delta\n",
    )
    nothing_lost("node.py", NODE, patched, {8})


def test_the_check_allows_the_changed_line_to_differ() -> None:
    nothing_lost("node.py", NODE, NODE.replace("vel = GAIN * delta", "vel = 2.2 * GAIN * delta"), {8})


def test_change_may_add_but_not_remove_an_imported_name() -> None:
    node = "from std_msgs.msg import Float64, String  # messages\n" + NODE
    nothing_lost("node.py", node, node.replace("import Float64", "import Bool, Float64"), {9})
    with pytest.raises(RepairError, match="import String"):
        nothing_lost("node.py", node, node.replace(", String", ""), {9})


@pytest.mark.parametrize(
    "lost",
    ["# how far, how fast\n", "  # 1/s", "; ok = err < 1", "    # towards the goal\n", "  # nearly there"],
)
def test_the_check_detects_a_lost_statement_or_comment(lost: str) -> None:
    assert lost in NODE
    with pytest.raises(RepairError, match="would remove"):
        nothing_lost("node.py", NODE, NODE.replace(lost, ""), {8})


def test_the_check_detects_a_change_of_another_line() -> None:
    with pytest.raises(RepairError, match="would remove `GAIN = 5`"):
        nothing_lost("node.py", NODE, NODE.replace("GAIN = 5", "GAIN = 6"), {8})


def test_the_check_detects_reordered_statements() -> None:
    swapped = NODE.replace("err = abs(delta); ok = err < 1", "ok = err < 1; err = abs(delta)")
    with pytest.raises(RepairError, match="would remove"):
        nothing_lost("node.py", NODE, swapped, {8})


def test_a_text_that_does_not_parse_is_refused() -> None:
    with pytest.raises(RepairError, match="would not parse"):
        nothing_lost("node.py", NODE, NODE + "if\n", {8})
