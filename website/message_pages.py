"""Write a page for each message in docs/messages.md, and a page that lists them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

SECTION = re.compile(r"^(##|###) (.+)$", re.MULTILINE)
LISTED = "messages.md"


class Message(NamedTuple):
    """A program's message: its group in docs/messages.md, its words, and the text that explains it."""

    group: str
    words: str
    text: str

    @property
    def slug(self) -> str:
        """Return the name of the message's page: its words in lower case, joined by hyphens."""
        return slug(self.words)


def slug(words: str) -> str:
    """Return words as part of a URL: in lower case, joined by hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")


def anchor(words: str) -> str:
    """Return GitHub's anchor for a heading, as used by the links in docs/."""
    return re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def split(page: str) -> tuple[str, list[Message]]:
    """Return the introduction of docs/messages.md and its messages; each text ends with that of its group."""
    ends = [*SECTION.finditer(page)]
    introduction = page[: ends[0].start()].strip()
    messages, group, lead = [], "", ""
    for found, following in zip(ends, [*ends[1:], None], strict=True):
        body = page[found.end() : following.start() if following else len(page)].strip()
        if found[1] == "##":
            group, lead = found[2], body
        else:
            messages.append(Message(group, found[2], f"{body}\n\n{lead}".strip()))
    return introduction, messages


def write(staged: Path) -> list[Message]:
    """Replace the staged page of messages by a list, and write a page for each. Raise ValueError for equal slugs."""
    introduction, messages = split((staged / LISTED).read_text("utf-8"))
    slugs = [message.slug for message in messages]
    twice = {slug for slug in slugs if slugs.count(slug) > 1}
    if twice:
        raise ValueError(f"docs/messages.md: two messages have the same address: {', '.join(sorted(twice))}")
    lines = [introduction]
    for group in dict.fromkeys(message.group for message in messages):
        of = [message for message in messages if message.group == group]
        lines.append(f"## {group}\n\n" + "\n".join(f"- [{one.words}](messages/{one.slug}.md)" for one in of))
    (staged / LISTED).write_text("\n\n".join(lines) + "\n", "utf-8")
    addresses = {anchor(message.words): message.slug for message in messages}
    for page in staged.rglob("*.md"):
        _relink(page, addresses)
    folder = staged / "messages"
    folder.mkdir()
    for message in messages:
        (folder / f"{message.slug}.md").write_text(_page(message, addresses), "utf-8")
    return messages


def _relink(page: Path, addresses: Mapping[str, str]) -> None:
    """Replace links to headings in messages.md by links to pages. Raise ValueError for an unknown heading."""

    def moved(match: re.Match[str]) -> str:
        if match[2] not in addresses:
            raise ValueError(f"{page.name}: docs/messages.md has no heading #{match[2]}")
        return f"]({match[1]}messages/{addresses[match[2]]}.md)"

    text = page.read_text("utf-8")
    linked = re.sub(r"\]\(((?:\.\./)*)messages\.md#([^)\s]+)\)", moved, text)
    if linked != text:
        page.write_text(linked, "utf-8")


def _page(message: Message, addresses: Mapping[str, str]) -> str:
    deeper = re.sub(r"\]\((?!https?://|#)([^)\s]+)\)", r"](../\1)", message.text)
    deeper = re.sub(r"\]\(#([^)\s]+)\)", lambda found: f"]({addresses.get(found[1], found[1])}.md)", deeper)
    return f"# {message.words}\n\n{deeper}\n\n[All messages](../{LISTED}) · {message.group}\n"
