"""The messages, links and flags in the documentation exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pytest_tarl.flags import FLAGS

ROOT = Path(__file__).parent.parent
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")])
CODE = sorted(p for package in ("pytest_tarl", "tarl_lint") for p in (ROOT / package).rglob("*.py"))
SOURCE = "\n".join(path.read_text("utf-8") for path in CODE)
SPOKEN = re.sub(r'"\s*\n\s*f?"', "", SOURCE)  # sentences can span several lines


def headings(page: Path) -> list[str]:
    return re.findall(r"^### (.+)$", page.read_text("utf-8"), re.MULTILINE)


@pytest.mark.parametrize("message", headings(ROOT / "docs" / "messages.md"))
def test_every_explained_message_is_in_the_code(message: str) -> None:
    assert message in SPOKEN


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_between_pages_lead_to_files_that_exist(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text("utf-8"))
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing


def anchors(page: Path) -> set[str]:
    """Return the anchors that the headings of a page get, as GitHub and the site make them."""
    titles = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), re.MULTILINE)
    texts = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower() for title in titles]
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", text).strip()) for text in texts}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_anchors_of_links_are_headings_of_the_linked_page(page: Path) -> None:
    links = re.findall(r"\]\(((?:[\w./-]+\.md)?)#([^)\s]+)\)", page.read_text("utf-8"))
    assert [
        f"{name}#{anchor}"
        for name, anchor in links
        if anchor not in anchors(page.parent / name if name else page)
    ] == []


def outside_code(page: Path) -> list[str]:
    """Return the lines of a page, with those of code blocks emptied."""
    lines, fenced = [], False
    for line in page.read_text("utf-8").splitlines():
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        lines.append("" if fence or fenced or line.startswith("    ") else line)
    return lines


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_table_rows_have_equal_length(page: Path) -> None:
    for table in re.findall(r"(?:^\|.*\n)+", "\n".join(outside_code(page)) + "\n", re.MULTILINE):
        rows = table.splitlines()
        assert len(rows) > 1, rows[0]
        assert re.fullmatch(r"\|[\s:|-]+\|", rows[1]), rows[0]
        assert len({len(re.split(r"(?<!\\)\|", row)) for row in rows}) == 1, rows[0]


def test_every_mentioned_flag_exists() -> None:
    mentioned = {flag for page in PAGES for flag in re.findall(r"--tarl-[a-z]+", page.read_text("utf-8"))}
    assert mentioned
    assert mentioned - {flag.name for flag in FLAGS} == set()


def test_the_guide_mentions_every_flag() -> None:
    guide = (ROOT / "docs" / "guide.md").read_text("utf-8")
    assert {flag.name for flag in FLAGS if flag.name not in guide} == set()
