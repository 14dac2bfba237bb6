"""The sources of the site: each message has a page, snippets parse, and every page is in the menu."""

from __future__ import annotations

import ast
import json
import re
import textwrap
from pathlib import Path

import pytest

from website import message_pages, reference
from website.pages import GENERATED, ROOT, address, relinked, schemas, stage, written

yaml = pytest.importorskip("yaml")
tomllib = pytest.importorskip("tomllib", reason="the site is built on Python 3.11 or newer")

WRITTEN = [path for path in written().values() if path.suffix == ".md"]
PAGES = [path for path in WRITTEN if path.parent.name != "rules"]  # other tests run those snippets
FENCE = re.compile(r"^( *)```(\w+)[^\n]*\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def staged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pages = tmp_path_factory.mktemp("pages")
    stage(pages)
    message_pages.write(pages)
    return pages


def test_every_message_has_a_page_with_its_words(staged: Path) -> None:
    explained = re.findall(r"^### (.+)$", (ROOT / "docs" / "messages.md").read_text("utf-8"), re.MULTILINE)
    assert len(explained) > 100
    for words in explained:
        page = (staged / "messages" / f"{message_pages.slug(words)}.md").read_text("utf-8")
        assert page.startswith(f"# {words}\n\n")
        assert len(page.splitlines()) > 4  # message text, explanation, link back
    listed = re.findall(r"\]\(messages/(.+)\.md\)", (staged / "messages.md").read_text("utf-8"))
    assert sorted(listed) == sorted(path.stem for path in (staged / "messages").iterdir())


def test_two_messages_with_one_address_are_refused(tmp_path: Path) -> None:
    (tmp_path / "messages.md").write_text("# M\n\n## G\n\n### has no\n\na\n\n### has: no\n\nb\n")
    with pytest.raises(ValueError, match="has-no"):
        message_pages.write(tmp_path)


def test_links_to_headings_of_messages_lead_to_their_pages(tmp_path: Path) -> None:
    (tmp_path / "messages.md").write_text(
        "# M\n\n## G\n\n### never called x.y\n\nSee [b](#b).\n\n### b\n\n[g](guide.md)\n"
    )
    (tmp_path / "guide.md").write_text("[m](messages.md#never-called-xy)")
    message_pages.write(tmp_path)
    assert (tmp_path / "guide.md").read_text() == "[m](messages/never-called-x-y.md)"
    assert "[b](b.md)" in (tmp_path / "messages" / "never-called-x-y.md").read_text()
    assert "[g](../guide.md)" in (tmp_path / "messages" / "b.md").read_text()


def test_a_link_to_a_missing_page_is_refused() -> None:
    with pytest.raises(ValueError, match=r"guide\.md: the link nosuch\.md leads to no page"):
        relinked("[x](nosuch.md)", next(place for place in written() if place.name == "guide.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_snippets_of_each_page_are_valid(page: Path) -> None:
    readers = {"python": _python, "toml": tomllib.loads, "yaml": yaml.safe_load, "json": json.loads}
    for _, language, text in FENCE.findall(page.read_text("utf-8")):
        if language in readers:
            readers[language](textwrap.dedent(text).replace("…", "..."))  # placeholder for omitted code


def _python(snippet: str) -> None:
    """Parse a snippet; one that ends with a decorator shows the head of a function."""
    ast.parse(re.sub(r"(^@.*\n)\Z", r"\1def test(): ...", snippet, flags=re.MULTILINE))


def test_every_page_is_in_the_menu(staged: Path) -> None:
    menu = set(re.findall(r'"([\w/.-]+\.md)"', (ROOT / "website" / "zensical.toml").read_text("utf-8")))
    pages = {path.relative_to(staged).as_posix() for path in staged.rglob("*.md")}
    generated = {str(address(Path(page))) for page in GENERATED}
    reached = {page for page in pages if page.startswith("messages/")} | {"contributing/index.md"}
    wanted = (pages - reached) | generated | {"gallery/index.md"}
    assert menu == wanted, "name each page once in `nav` of website/zensical.toml"


def test_reference_pages_contain_every_option_setting_and_schema() -> None:
    from pytest_tarl.flags import FLAGS
    from tarl_lint.settings.schema import KEYS

    assert all(f"`{flag.name}" in reference.options() for flag in FLAGS)
    assert all(f"| `{key}` |" in reference.settings() for key in KEYS)
    assert all(f"`schemas/{path.name}`" in reference.schema_page() for path in schemas())
    helped = reference.commands()
    assert helped.count("usage: tarl ") == 9
    assert helped.count("usage: tarl-lint ") == 1


def test_schemas_have_stable_addresses(staged: Path) -> None:
    assert len(schemas()) >= 4
    for path in schemas():
        assert json.loads((staged / "schemas" / path.name).read_text("utf-8"))["title"]
