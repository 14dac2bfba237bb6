"""The site in a real browser, from disk and without a network: search, figures and accessibility."""

from __future__ import annotations

import json
import os
import re
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from html import unescape
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from tests.plugin.report.test_browser import BROWSER, DARK, OFFLINE, QUIET
from website import assets, links
from website.message_pages import slug
from website.publish import publish

WAIT = """const pause = time => new Promise(done => setTimeout(done, time));
const until = async found => { for (let i = 0; i < 200 && !found(); i++) await pause(50); return found() };"""
SEARCH = """document.querySelector(".md-search__button").click();
const shown = () => [...document.querySelectorAll("*")].find(one => one.shadowRoot)?.shadowRoot;
await until(() => shown()?.querySelector("input"));
const input = shown().querySelector("input"), results = () => [...shown().querySelectorAll("ol a")];
const write = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
for (const query of QUERIES) {
  write.call(input, query); input.dispatchEvent(new Event("input", {bubbles: true}));
  const mine = () => results().filter(link => new URL(link.href).searchParams.get("h") === query);
  await until(() => mine().length);
  found[query] = mine().map(link => new URL(link.href).pathname);
}"""
READ = """await until(() => !document.querySelector("pre.mermaid"));
found.drawn = [...document.querySelectorAll("div.mermaid")].map(one => one.clientHeight);
found.fonts = [...new Set([...document.fonts].filter(one => one.status === "loaded").map(one => one.family))].sort();
found.loaded = performance.getEntriesByType("resource").map(one => one.name).filter(name => !name.startsWith("file:"));
const result = await axe.run(document, {runOnly: ["wcag2a", "wcag2aa"]});
found.axe = result.violations.map(one => one.id + ": " + one.nodes.map(node => node.html.slice(0, 200)).join(" "));
found.passed = result.passes.map(one => one.id);
found.background = getComputedStyle(document.body).backgroundColor;"""

READ_PAGES = [("lint.html", False)]
if os.environ.get("TARL_SLOW") or os.environ.get("TARL_SITE"):
    READ_PAGES += [
        ("lint.html", True),
        ("index.html", False),
        ("tutorial.html", False),
        ("reference/api.html", True),
    ]
    READ_PAGES += [("messages.html", True), ("rules/TARL202.html", False), ("reference/commands.html", False)]


def opened(
    site: Path, page: str, script: str, directory: Path, *flags: str, at: str = ""
) -> tuple[dict[str, Any], list[str]]:
    """Return the result of a script on a page, and the lines of the console."""
    if BROWSER is None:
        pytest.skip("no browser is installed, so the site was not opened")
    body = f"const found = {{}};{WAIT}{script}\ndocument.body.dataset.found = JSON.stringify(found);"
    probe = f'<script>addEventListener("load", async () => {{{body}}})</script></body>'
    text = (site / page).read_text("utf-8")
    file = (site / page).with_name(
        f"{directory.name}.htm"
    )  # beside the page, so that its relative links work
    file.write_text(text.replace("</body>", probe), "utf-8")
    profile = f"--user-data-dir={directory / 'profile'}"
    local = "--allow-file-access-from-files"
    offline = f"{OFFLINE}, EXCLUDE 127.0.0.1" if at else OFFLINE
    command = [
        BROWSER,
        *QUIET.split(),
        offline,
        local,
        *flags,
        profile,
        "--window-size=1280,900",
        "--dump-dom",
    ]
    try:
        address = f"{at}/{file.name}" if at else file.as_uri()
        ran = subprocess.run([*command, address], capture_output=True, text=True, timeout=120, check=True)
    finally:
        file.unlink()
    body_tag = re.search(r'<body[^>]* data-found="([^"]*)"', ran.stdout)
    assert body_tag, f"The page never finished: {ran.stderr[-2000:]}"
    return json.loads(unescape(body_tag[1])), [line for line in ran.stderr.splitlines() if "CONSOLE" in line]


@pytest.fixture(scope="session")
def axe() -> str:
    """Return the text of axe-core, or skip."""
    if not assets.available(assets.TESTED_WITH):
        pytest.skip("run `make docs-assets` once: axe-core is not in build/assets")
    return (assets.KEPT / "axe" / "axe.min.js").read_text("utf-8")


def test_links_lead_to_pages_and_headings(site: Path) -> None:
    assert links.broken(site) == []


def test_a_broken_link_and_an_external_script_are_reported(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<h1 id="here"></h1><a href="b.html">b</a><a href="#there">c</a><a href="#here">d</a>'
    )
    (tmp_path / "c.html").write_text(
        '<script src="https://example.org/x.js"></script><a href="a.html#nosuch">e</a>'
    )
    assert links.broken(tmp_path) == [
        "a.html: b.html leads to no file",
        "a.html: #there leads to no heading",
        "c.html: loads https://example.org/x.js from the network",
        "c.html: a.html#nosuch leads to no heading",
    ]


def test_search_finds_rules_and_messages(site: Path, tmp_path: Path) -> None:
    queries = ["no such sensor", "TARL202"]
    found, console = opened(site, "index.html", SEARCH.replace("QUERIES", json.dumps(queries)), tmp_path)
    assert found["no such sensor"][0].endswith(f"/messages/{slug('no such sensor or signal')}.html")
    assert found["TARL202"][0].endswith("/rules/TARL202.html")
    assert console == []


@pytest.mark.parametrize(("page", "dark"), READ_PAGES)
def test_pages_are_accessible_to_readers_with_disabilities(
    site: Path, axe: str, tmp_path: Path, page: str, dark: bool
) -> None:
    text = json.dumps(axe).replace("</script>", "<\\/script>")
    script = f"document.head.append(Object.assign(document.createElement('script'), {{text: {text}}}));{READ}"
    found, console = opened(site, page, script, tmp_path, *[DARK] * dark)
    assert found["axe"] == []
    assert "color-contrast" in found["passed"]
    assert found["fonts"] == ["Inter", "JetBrains Mono"]
    assert found["loaded"] == []
    assert console == []
    assert (found["background"] != "rgb(255, 255, 255)") == dark
    if page == "lint.html":
        assert all(height > 100 for height in found["drawn"])
        assert found["drawn"]


def test_the_menu_of_versions_leads_to_each_of_them(site: Path, tmp_path: Path) -> None:
    if 'provider":"mike"' not in (site / "index.html").read_text("utf-8"):
        pytest.skip("the site was built without SITE_URL, so it has no menu of versions")
    for tag in ("v0.1.0", "v0.2.0", "dev"):
        publish(site, tmp_path / "tree", tag)
    script = """await until(() => document.querySelector(".md-version a"));
found.versions = [...document.querySelectorAll(".md-version a")].map(link => link.textContent.trim());"""
    with served(tmp_path / "tree") as address:
        found, console = opened(
            tmp_path / "tree" / "0.1.0", "index.html", script, tmp_path, at=f"{address}/0.1.0"
        )
    assert found["versions"] == ["0.2.0", "0.1.0", "dev"]
    assert console == []


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder on this machine; give its address."""
    handler = partial(Silent, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()


class Silent(SimpleHTTPRequestHandler):
    """Serve files without logging."""

    def log_message(self, *_: object) -> None:
        """Discard a line of the log."""
