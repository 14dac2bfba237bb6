"""Two changes of the same lines: both take effect, or they conflict."""

from __future__ import annotations

import re

import pytest

from pytest_tarl.patching.changes import Replacement
from pytest_tarl.patching.same_lines import agreed


def change(old: str, new: str, start: int = 3) -> Replacement:
    return Replacement(
        start, tuple(old.encode().splitlines(keepends=True)), tuple(new.encode().splitlines(keepends=True))
    )


def names(made: Replacement) -> list[str]:
    return sorted(re.findall(r"\w+", b"".join(made.new).decode()))


@pytest.mark.parametrize(
    ("old", "one", "other", "both"),
    [
        ("from a import x\n", "from a import b, x\n", "from a import c, x\n", "from a import b, c, x\n"),
        (
            "from a import x, b\n",
            "from a import x, b, d\n",
            "from a import x, b, c\n",
            "from a import x, b, d, c\n",
        ),
        ("import a\n", "import a\nimport b\n", "import a\nimport c\n", "import a\nimport b\nimport c\n"),
        ("from . import x\n", "from . import w, x\n", "from . import x, y\n", "from . import w, x, y\n"),
        ("import a\r\n", "import a\r\nimport b\r\n", "import a\r\nimport b\r\n", "import a\r\nimport b\r\n"),
        ("", "x = 1\n", "x = 1\ny = 2\n", "x = 1\ny = 2\n"),
        ("", "y = 2\nz = 3\n", "x = 1\ny = 2\nz = 3\n", "x = 1\ny = 2\nz = 3\n"),
    ],
)
def test_compatible_changes_of_one_line_are_merged(old: str, one: str, other: str, both: str) -> None:
    assert agreed(change(old, one), change(old, other)) == change(old, both)
    turned = agreed(change(old, other), change(old, one))
    assert turned is not None
    assert names(turned) == names(change(old, both))


@pytest.mark.parametrize(
    ("old", "one", "other"),
    [
        ("from a import x\n", "from a import b\n", "from a import c, x\n"),  # one removes a name
        ("from a import x\n", "from a import c, x\n", "from a import b\n"),
        ("import a\n", "import a\nimport b\n", "x = 1\n"),
        ("import a\n", "import a\nimport b  # why\n", "import a\nimport c\n"),  # the comment would be lost
        ("import a\n", "import a\n    import b\n", "import a\nimport c\n"),
        ("x = 1\n", "x = 2\n", "x = 3\n"),
        ("", "x = 1\n", "y = 2\n"),
        ("", "x = 1\ny = 2\n", "x = 1\nz = 3\ny = 2\n"),  # not one insertion within the other
    ],
)
def test_incompatible_changes_of_one_line_are_not_merged(old: str, one: str, other: str) -> None:
    assert agreed(change(old, one), change(old, other)) is None


def test_changes_of_different_lines_are_not_merged_into_one() -> None:
    assert agreed(change("", "x = 1\n"), change("", "x = 1\n", start=4)) is None
