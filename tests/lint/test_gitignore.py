import re
import subprocess
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tarl_lint.read.gitignore import ignored, parse

CASES = [
    ("*.pyc", "a/b.pyc", True),
    ("*.pyc", "a/b.py", False),
    ("build/", "build", True),
    ("build/", "a/build", True),
    ("/build", "a/build", False),
    ("a/b", "a/b", True),
    ("a/b", "c/a/b", False),
    ("**/b", "c/a/b", True),
    ("a/**", "a/x/y", True),
    ("a/**/z", "a/z", True),
    ("a/**/z", "a/x/y/z", True),
    ("a*/z", "ab/c/z", False),
    ("?.py", "x.py", True),
    ("?.py", "xy.py", False),
    ("[ab].py", "b.py", True),
    ("[!ab].py", "b.py", False),
    ("[!ab].py", "c.py", True),
    (r"\#x", "#x", True),
    (r"\!x", "!x", True),
    ("# comment", "# comment", False),
    ("x ", "x", True),
    ("", "x", False),
    ("[", "[", False),
    ("a+b.py", "a+b.py", True),
    ("a+b.py", "aab.py", False),
]


def left_out(lines: list[str], path: str, *, is_directory: bool = True) -> bool:
    return ignored(f"/top/{path}", [parse("/top", lines)], is_directory=is_directory)


@pytest.mark.parametrize(("pattern", "path", "expected"), CASES)
def test_patterns_match_like_in_git(pattern, path, expected):
    assert left_out([pattern], path) is expected


def test_the_last_matching_pattern_decides():
    assert not left_out(["*.py", "!keep.py"], "keep.py")
    assert left_out(["!keep.py", "*.py"], "keep.py")


def test_a_directory_pattern_does_not_match_files():
    assert not left_out(["build/"], "build", is_directory=False)


def test_the_nearest_ignore_file_decides_for_its_own_directory():
    outer, inner = parse("/top", ["*.py"]), parse("/top/a", ["!*.py"])
    assert ignored("/top/x.py", [outer, inner], is_directory=False)
    assert not ignored("/top/a/x.py", [outer, inner], is_directory=False)
    assert ignored("/top/ab/x.py", [outer, inner], is_directory=False)


lines_of_patterns = st.text("ab*?/!.[]\\^", min_size=1, max_size=6).filter(
    lambda line: (
        not re.search(r"[^/]\*\*+/|/\*\*+[^/*]", line)
    )  # git strips the literal prefix before it interprets `**`
)


@settings(
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.lists(lines_of_patterns, min_size=1, max_size=3))
def test_the_results_agree_with_git(tmp_path: Path, lines: list[str]):
    """Compare with `git check-ignore` on paths whose parents are not ignored (git does not descend into those)."""
    if not (tmp_path / ".git").exists():
        subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    (tmp_path / ".gitignore").write_text("\n".join(lines) + "\n")
    names = ["a", "b", "ab", "a.b", "b.a", "aa.b", "bb"]
    asked = subprocess.run(
        ["git", "-c", "core.excludesFile=/dev/null", "check-ignore", "--no-index", *names],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    ours = [n for n in names if ignored(f"{tmp_path}/{n}", [parse(str(tmp_path), lines)], is_directory=False)]
    assert ours == asked.stdout.split()


@given(
    st.lists(st.sampled_from(["*a", "**/", "?*", "[ab]*", "*", "a*/", "*b*"]), min_size=10, max_size=60),
    st.lists(st.sampled_from(["a" * 60, "a", "ab" * 30]), min_size=1, max_size=40),
)
def test_no_pattern_of_a_gitignore_file_needs_exponential_time(pieces: list[str], names: list[str]):
    """Backtracking expressions need exponential time for `*a*a*a…b` against a name of many letters a."""
    parse("/top", ["".join(pieces) + "c"]).verdict(f"/top/{'/'.join(names)}", is_directory=False)
