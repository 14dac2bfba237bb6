"""Each command of the tutorial, and of the guides that show a whole project, prints what the page shows."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from website.page_commands import TUTORIAL, blocks, renewed, run, same, shortened
from website.pages import ROOT

PAGES = (TUTORIAL, *sorted(ROOT.glob("docs/howto/*.md")))
SLOW = os.environ.get("TARL_SLOW") or os.environ.get(
    "TARL_SITE"
)  # the guides run nightly and when the site is built
RUN = [
    page
    for page in PAGES
    if any(block.file for block in blocks(page.read_text("utf-8"))) and (SLOW or page == TUTORIAL)
]


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_tutorial_commands_print_what_is_shown(page: Path, tmp_path: Path) -> None:
    text = page.read_text("utf-8")
    ran = list(run(text, tmp_path))
    other = [
        f"$ {one.command.line}\n{one.printed}" for one in ran if not same(one.command.output, one.printed)
    ]
    assert not other, f"renew the page with `python -m website.tutorial --write {page}`:\n" + "\n".join(other)
    shown = [
        command
        for block in blocks(text)
        if not block.nightly and not block.file
        for command in block.commands()
    ]
    assert [one.command for one in ran] == shown
    assert renewed(text, ran) == text


def test_the_tutorial_ends_with_a_merged_patch() -> None:
    lines = [command.line for block in blocks(TUTORIAL.read_text("utf-8")) for command in block.commands()]
    assert [line for line in lines if line.startswith(("tarl apply", "git merge"))] == [
        "tarl apply .tarl/patches/*.patch",
        "git merge --quiet worn-tyres",
    ]


@pytest.mark.parametrize(
    "page", [TUTORIAL, *sorted((ROOT / "docs" / "howto").glob("*.md"))], ids=lambda page: page.stem
)
def test_the_installed_extras_suffice_without_ros(page: Path) -> None:
    installed = re.findall(r'install [^\n]*"tarl\[([\w,]+)\]"', page.read_text("utf-8"))
    assert all({"pytest", "ros", "report"} <= set(extras.split(",")) for extras in installed)
    assert installed or page != TUTORIAL


def test_outputs_are_compared_except_for_digests_and_times() -> None:
    shown = "wrote 45d58605.npz\n1 passed in 0.42s\n"
    assert same(shown, "wrote 00000000.npz\n1 passed in 10.01s\n")
    assert same(shown, "wrote 00000000.npz\n1 passed in 71.30s (0:01:11)\n")  # as pytest writes from 60 s on
    assert not same(shown, "wrote 00000000.npz\n2 passed in 0.42s\n")
    assert not same(shown, shown + "one more\n")
    assert not same("", "output where none is shown\n")


def test_omitted_lines_may_contain_anything() -> None:
    assert same("a\n...\nz\n", "a\nb\nc\nz\n")
    assert same("a\n...\nz\n", "a\nz\n")
    assert not same("a\n...\nz\n", "a\nb\n")
    assert shortened("a\n...\nz\n", "1\n2\n3\n4\n") == "1\n...\n4\n"
    assert shortened("cut off...\nz\n", "1\n2\n3\n4\n") == "1\n2\n3\n4\n"


def test_outdated_output_in_a_page_is_replaced(tmp_path: Path) -> None:
    page = 'Text.\n\n```text title="a.txt"\nhello\n```\n\n```console\n$ cat a.txt\nbye\n$ echo two\ntwo\n```\n\nMore.\n'
    ran = list(run(page, tmp_path))
    assert renewed(page, ran) == page.replace("bye", "hello")


@pytest.mark.skipif(not os.environ.get("TARL_SLOW"), reason="installs packages; runs with TARL_SLOW=1")
def test_the_tutorial_runs_in_a_new_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = TUTORIAL.read_text("utf-8").replace('"tarl[', f'"{ROOT}[')
    ran = list(run(text, tmp_path, nightly=True))
    assert (tmp_path / "tarl-venv" / "bin" / "tarl").exists()
    assert [one.command.line for one in ran if not same(one.command.output, one.printed)] == []
