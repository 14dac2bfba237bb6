"""Names that a module imports, and the places at which a repair adds imports."""

from __future__ import annotations

from textwrap import dedent

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.patching.imports import Import, import_edits, imported, reference, top_imports


@pytest.mark.parametrize(
    ("text", "expression"),
    [
        ("from std_msgs.msg import Bool", "Bool"),
        ("from std_msgs.msg import Int8, Bool as Flag", "Flag"),
        ("from std_msgs.msg import *", "Bool"),
        ("import std_msgs.msg", "std_msgs.msg.Bool"),
        ("import rospy, std_msgs.msg as m", "m.Bool"),
        ("from std_msgs.msg import Int8", ""),
        ("from .std_msgs.msg import Bool", ""),
        ("from other.msg import Bool", ""),
        ("import std_msgs", ""),
        ("def f():\n    from std_msgs.msg import Bool", ""),
        ("if True:\n    from std_msgs.msg import Bool", "Bool"),
    ],
)
def test_imported_name_follows_the_imports_of_the_file(text: str, expression: str) -> None:
    assert imported(document("node.py", text + "\n"), "std_msgs.msg", "Bool") == expression


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("from pkg.gains import kp", ("wet", Import("pkg.gains", "wet"))),
        ("from gains import kp", ("wet", Import("gains", "wet"))),
        ("from .gains import kp", ("wet", Import(".gains", "wet"))),
        ("from ..pkg.gains import kp", ("wet", Import("..pkg.gains", "wet"))),
        ("from pkg import gains", ("gains.wet", None)),
        ("from pkg import gains as g", ("g.wet", None)),
        ("from . import gains", ("gains.wet", None)),
        ("import pkg.gains", ("pkg.gains.wet", None)),
        ("import gains as g", ("g.wet", None)),
        ("import pkg", None),
        ("from other import gains", None),
        ("from pkg.gain import kp", None),
        ("from other.gains import kp", None),
        ("import other.gains", None),
        ("", None),
    ],
)
def test_new_name_is_accessed_like_its_module(text: str, found: tuple[str, Import | None] | None) -> None:
    assert reference(document("node.py", text + "\n"), "pkg.gains", "wet") == found


def added(text: str, *wanted: Import) -> str:
    """Return the text with the imports added."""
    text = dedent(text)
    for edit in sorted(import_edits(document("node.py", text), wanted), key=lambda one: -one.start):
        text = text[: edit.start] + edit.text + text[edit.end :]
    return text


BOOL = Import("std_msgs.msg", "Bool")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("from std_msgs.msg import Int8\n", "from std_msgs.msg import Bool, Int8\n"),
        ("from std_msgs.msg import Aim, Int8\n", "from std_msgs.msg import Aim, Bool, Int8\n"),
        ("from std_msgs.msg import Int8, Aim\n", "from std_msgs.msg import Int8, Aim, Bool\n"),
        ("from std_msgs.msg import Aim\n", "from std_msgs.msg import Aim, Bool\n"),
        (
            "from std_msgs.msg import (\n    Aim,\n    Int8,\n)\n",
            "from std_msgs.msg import (\n    Aim,\n    Bool,\n    Int8,\n)\n",
        ),
        (
            "from std_msgs.msg import (\n    Aim,\n    Ask,\n)\n",
            "from std_msgs.msg import (\n    Aim,\n    Ask,\n    Bool,\n)\n",
        ),
        ("import rospy\n\nx = 1\n", "import rospy\nfrom std_msgs.msg import Bool\n\nx = 1\n"),
        (
            "import rospy\nfrom nav_msgs.msg import Path\nimport sys\n",
            "import rospy\nfrom nav_msgs.msg import Path\nfrom std_msgs.msg import Bool\nimport sys\n",
        ),
        (
            "import rospy\nfrom tf2_msgs.msg import TF\nimport sys\n",
            "import rospy\nfrom std_msgs.msg import Bool\nfrom tf2_msgs.msg import TF\nimport sys\n",
        ),
        ('"""Drive."""\n\nx = 1\n', '"""Drive."""\n\nfrom std_msgs.msg import Bool\n\nx = 1\n'),
        ("x = 1\n", "from std_msgs.msg import Bool\n\nx = 1\n"),
        ("import a; import b\nx = 1\n", "from std_msgs.msg import Bool\n\nimport a; import b\nx = 1\n"),
        (
            "import a\ndef f(): pass\nfrom std_msgs.msg import Int8\n",
            "import a\nfrom std_msgs.msg import Bool\ndef f(): pass\nfrom std_msgs.msg import Int8\n",
        ),
    ],
)
def test_import_is_added_where_a_maintainer_would(before: str, after: str) -> None:
    assert added(before, BOOL) == after


def test_names_of_one_module_are_imported_together() -> None:
    wanted = [BOOL, Import("std_msgs.msg", "Int8", "I"), BOOL, Import("math"), Import("math", alias="m")]
    assert added("import sys\n", *wanted[:3]) == "import sys\nfrom std_msgs.msg import Bool, Int8 as I\n"
    assert added("import sys\n", *wanted[3:]) == "import sys\nimport math, math as m\n"
    assert added("from math import pi\n", Import("math")) == "from math import pi\nimport math\n"


def test_relative_import_is_extended_by_its_module_only() -> None:
    assert added("from .gains import kp\n", Import(".gains", "wet")) == "from .gains import kp, wet\n"
    assert added("from .gains import kp\n", Import("gains", "wet")) == (
        "from .gains import kp\nfrom gains import wet\n"
    )


def test_an_alias_equal_to_the_name_is_not_written() -> None:
    assert Import("m", "name", "name").written == "name"
    assert Import("m", "name", "other").written == "name as other"
    assert Import("m.n").written == "m.n"


def test_function_imports_do_not_count_for_the_module() -> None:
    text = "import a\nclass C:\n    import b\n    def f(self):\n        import c\n"
    assert [node.names[0].name for node in top_imports(document("n.py", text))] == ["a", "b"]
