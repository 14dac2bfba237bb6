"""Check the built site: every linked file and anchor exists, and no page loads anything from the network."""

from __future__ import annotations

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {("img", "src"), ("script", "src"), ("iframe", "src"), ("source", "src"), ("object", "data")}


class Page(HTMLParser):
    """The anchors that a page defines, its links, and the addresses that it loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the anchors and addresses of an element."""
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if tag == "link" and set(values.get("rel", "").split()) & {
            "stylesheet",
            "icon",
            "preload",
            "preconnect",
        }:
            self.loaded.append(values["href"])
        self.loaded += [values[name] for name in values if (tag, name) in LOADED]


def broken(site: Path) -> list[str]:
    """Return a sentence for each broken link and each address loaded from the network, in the order of pages."""
    reports = {*site.glob("gallery/*.html")} - {site / "gallery" / "index.html"}  # reports are self-contained
    files = sorted({*site.rglob("*.html")} - reports)
    pages = {path: Page(path.read_text("utf-8")) for path in files}
    return [problem for path, page in pages.items() for problem in _broken(site, path, page, pages)]


def _broken(site: Path, path: Path, page: Page, pages: dict[Path, Page]) -> Iterator[str]:
    name = path.relative_to(site)
    for loaded in page.loaded:
        if urlsplit(loaded).netloc:
            yield f"{name}: loads {loaded} from the network"
    for link in (*page.links, *page.loaded):
        parts = urlsplit(link)
        if parts.scheme or parts.netloc or path.name == "404.html":
            continue
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        target = target / "index.html" if target.is_dir() else target
        if not target.is_file():
            yield f"{name}: {link} leads to no file"
        elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
            yield f"{name}: {link} leads to no heading"
