"""The sample of sentences for readers: all kinds of text are drawn, code and labels are not."""

from __future__ import annotations

from pathlib import Path

from benchmarks.readers_sample import CODE, blind, pools_of, sample

MODULE = '''"""A module with a first sentence. And with a second one."""

LIMIT = 3  # steps that a search may take
MORE = 4  # further steps after the limit
# A comment of two lines
# is one sentence.


def f(path: str) -> None:
    raise ValueError(f"{path} is not a file: check the path")
'''


def _project(tmp_path: Path) -> Path:
    """Write a project with each kind of text."""
    for folder in ("docs/rules", "tarl_lint", "pytest_tarl", "tests"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "docs" / "a.md").write_text(
        "# Title\n\nThis is a sentence\nof two lines.\n\n```sh\nnot a sentence of prose\n```\n"
    )
    (tmp_path / "docs" / "rules" / "TARL1.md").write_text("The rule reports what is wrong.\n")
    (tmp_path / "tarl_lint" / "a.py").write_text(MODULE)
    (tmp_path / "pytest_tarl" / "page.html").write_text(
        "<p>The page shows a figure.</p><style>a b c d e {}</style>"
    )
    (tmp_path / "tests" / "test_a.py").write_text("def test_it_has_a_long_name() -> None: ...\n")
    return tmp_path


def test_equal_seeds_draw_equal_samples_of_every_kind(tmp_path: Path) -> None:
    _project(tmp_path)
    drawn = sample(tmp_path, 100, seed=1)
    assert sorted(drawn) == [
        ("comment", "tarl_lint/a.py", "A comment of two lines is one sentence."),
        ("comment", "tarl_lint/a.py", "further steps after the limit"),
        ("comment", "tarl_lint/a.py", "steps that a search may take"),
        ("docs", "docs/a.md", "This is a sentence of two lines."),
        ("docstring", "tarl_lint/a.py", "A module with a first sentence."),
        ("docstring", "tarl_lint/a.py", "And with a second one."),
        ("message", "tarl_lint/a.py", "{path} is not a file: check the path"),
        ("page", "pytest_tarl/page.html", "The page shows a figure."),
        ("rule page", "docs/rules/TARL1.md", "The rule reports what is wrong."),
        ("test name", "tests/test_a.py", "test_it_has_a_long_name"),
    ]
    assert sample(tmp_path, 100, seed=1) == drawn
    assert sample(tmp_path, 3, seed=1) == drawn[:3]


def test_other_projects_have_the_shared_kinds(tmp_path: Path) -> None:
    other = tmp_path / "other-1.0"
    (other / "doc" / "en").mkdir(parents=True)
    (other / "src" / "other").mkdir(parents=True)
    (other / "testing").mkdir()
    (other / "doc" / "en" / "a.rst").write_text(
        "A title of four words\n=====================\n\nThis is a sentence\nof two lines.\n\n"
        ".. note::\n\n    A note that is not drawn.\n"
    )
    (other / "src" / "other" / "a.py").write_text(MODULE)
    (other / "testing" / "test_a.py").write_text(
        "def test_it_has_a_long_name() -> None:\n    'Not drawn at all.'\n"
    )
    (tmp_path / "ours").mkdir()
    projects = {"ours": pools_of(_project(tmp_path / "ours"), CODE), "other": pools_of(other, ("**",))}
    drawn = blind(projects, 10, seed=1)
    theirs = sorted(kind for project, (kind, _, _) in drawn if project == "other")
    assert theirs == ["comment"] * 3 + ["docs"] + ["docstring"] * 2 + ["message", "test name"]
    assert ("other", ("docs", "doc/en/a.rst", "This is a sentence of two lines.")) in drawn
    ours = sorted(kind for project, (kind, _, _) in drawn if project == "ours")
    assert ours == theirs, "a rule page or a page of a report is drawn, although the other project has none"
    assert drawn == blind(projects, 10, seed=1)
    order = [project for project, _ in drawn]
    assert order not in (sorted(order), sorted(order, reverse=True))
