"""The addresses in the metadata of a wheel, and the links that follow from them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from email.message import Message
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

from tarl_lint import documentation, explain
from tarl_lint.report.sarif import document
from tarl_lint.run.runner import Result
from website.project_urls import urls

ROOT = Path(__file__).resolve().parent.parent
SITE = "https://robots.example/tarl"


@pytest.fixture(autouse=True)
def forget() -> Iterator[None]:
    documentation.site.cache_clear()
    yield
    documentation.site.cache_clear()


def installed_with(stated: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Pretend that the installed version states these project URLs."""
    metadata = Message()
    for one in stated:
        metadata["Project-URL"] = one
    monkeypatch.setattr(documentation, "metadata", lambda _: metadata)


def test_a_wheel_states_the_addresses_of_the_environment(monkeypatch):
    monkeypatch.setenv("SITE_URL", f"{SITE}/")
    monkeypatch.setenv("REPOSITORY_URL", "https://forge.example/robots/tarl")
    stated = ProjectMetadata(str(ROOT), PluginManager()).core.urls
    assert stated == {
        "Documentation": f"{SITE}/",
        "Source": "https://forge.example/robots/tarl",
        "Issues": "https://forge.example/robots/tarl/issues",
        "Changelog": "https://forge.example/robots/tarl/blob/main/CHANGELOG.md",
    }


def test_without_addresses_a_wheel_states_none(monkeypatch):
    monkeypatch.delenv("SITE_URL", raising=False)
    monkeypatch.delenv("REPOSITORY_URL", raising=False)
    assert ProjectMetadata(str(ROOT), PluginManager()).core.urls == {}


@pytest.mark.parametrize("address", ["robots.example", "http://robots.example", "javascript:alert(1)"])
def test_an_address_without_https_is_refused(address):
    with pytest.raises(ValueError, match="SITE_URL must be an address that begins with https://"):
        urls({"SITE_URL": address})


def test_rules_in_sarif_link_to_their_pages(monkeypatch):
    installed_with(["Source, https://forge.example/tarl", f"Documentation, {SITE}"], monkeypatch)
    driver = document(Result())["runs"][0]["tool"]["driver"]
    assert driver["informationUri"] == f"{SITE}/"
    assert {one["id"]: one["helpUri"] for one in driver["rules"]} == {
        code: f"{SITE}/rules/{code}/" for code in explain.known_rules()
    }


@pytest.mark.parametrize("stated", [[], ["Source, https://forge.example/tarl"]])
def test_without_a_documentation_address_there_are_no_links(stated, monkeypatch):
    installed_with(stated, monkeypatch)
    assert "helpUri" not in json.dumps(document(Result()))
    assert "informationUri" not in json.dumps(document(Result()))


def test_uninstalled_source_tree_has_no_links(monkeypatch):
    def missing(_: str) -> Message:
        raise PackageNotFoundError("tarl")

    monkeypatch.setattr(documentation, "metadata", missing)
    assert documentation.rule_page("TARL101") == ""


def test_editor_links_a_code_to_its_page(monkeypatch):
    pytest.importorskip("lsprotocol")
    from pytest_tarl.editor.diagnostics import diagnostics
    from pytest_tarl.editor.positions import Places
    from tarl_lint.read.source import SourceError

    installed_with([f"Documentation, {SITE}/"], monkeypatch)
    texts = {"node.py": "def ("}
    result = type(
        "Found", (), {"texts": texts, "findings": (), "errors": (SourceError("node.py", 1, "syntax"),)}
    )()
    (found,) = diagnostics(result, Places(ROOT, texts))["node.py"]
    assert found.code_description.href == f"{SITE}/rules/TARL001/"


def test_every_linked_page_exists_in_the_site():
    for code in explain.known_rules():
        assert (ROOT / "docs/rules" / f"{code}.md").is_file()
