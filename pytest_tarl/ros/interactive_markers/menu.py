"""Menus of interactive markers: entries with a callback, a parent and a check mark."""

# ruff: noqa: N802 (names and signatures are those of interactive_markers)

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pytest_tarl.ros.interactive_markers.server import MESSAGES, InteractiveMarkerServer
from pytest_tarl.ros.interactive_markers.server import __getattr__ as __getattr__

__all__ = ["MenuHandler", *MESSAGES]

_MENU_SELECT = 2  # InteractiveMarkerFeedback.MENU_SELECT
_MARKS = {1: "[ ] ", 2: "[x] "}  # text before an entry's title, by check state


@dataclass
class _Entry:
    """A menu entry; `parent` is 0 at the top level."""

    title: str
    parent: int
    callback: Callable[[Any], Any] | None
    command: str
    command_type: int
    check: int = 0
    visible: bool = True


class MenuHandler:
    """A menu for one or more markers; entries are numbered from 1."""

    NO_CHECKBOX, UNCHECKED, CHECKED = 0, 1, 2

    def __init__(self) -> None:
        self._entries: dict[int, _Entry] = {}
        self._managed: dict[str, InteractiveMarkerServer] = {}

    def insert(
        self,
        title: str,
        parent: int | None = None,
        command_type: int = 0,
        command: str = "",
        callback: Callable[[Any], Any] | None = None,
    ) -> int | None:
        """Add an entry at the top level or below another; return its number, or None if `parent` does not exist."""
        if parent and parent not in self._entries:
            return None
        number = len(self._entries) + 1
        self._entries[number] = _Entry(title, parent or 0, callback, command, command_type)
        return number

    def setVisible(self, handle: int, visible: bool) -> bool:
        """Show or hide an entry; return whether it exists."""
        return self._set(handle, "visible", visible)

    def setCheckState(self, handle: int, check_state: int) -> bool:
        """Set an entry's check mark; return whether the entry exists."""
        return self._set(handle, "check", check_state)

    def getCheckState(self, handle: int) -> int | None:
        """Return an entry's check mark, or None if the entry does not exist."""
        entry = self._entries.get(handle)
        return None if entry is None else entry.check

    def getTitle(self, handle: int) -> str | None:
        """Return an entry's title, or None if the entry does not exist."""
        entry = self._entries.get(handle)
        return None if entry is None else entry.title

    def apply(self, server: InteractiveMarkerServer, marker_name: str) -> bool:
        """Give this menu to a marker; return whether the server has the marker. `applyChanges` publishes it."""
        marker = server.get(marker_name)
        if marker is None:
            self._managed.pop(marker_name, None)
            return False
        make: Any = server._message("MenuEntry")
        marker.menu_entries = [
            make(
                id=number,
                parent_id=entry.parent,
                title=_MARKS.get(entry.check, "") + entry.title,
                command=entry.command,
                command_type=entry.command_type,
            )
            for number, entry in self._entries.items()
            if self._is_visible(entry)
        ]
        server.insert(marker, self.processFeedback, _MENU_SELECT)
        self._managed[marker_name] = server
        return True

    def reApply(self, server: InteractiveMarkerServer) -> bool:
        """Update the menu of all markers that have it; return whether they all still exist."""
        names = [name for name, owner in self._managed.items() if owner is server]
        applied = [self.apply(server, name) for name in names]
        return all(applied)

    def processFeedback(self, feedback: Any) -> None:
        """Call the callback of the entry selected by the user."""
        entry = self._entries.get(feedback.menu_entry_id)
        if entry is not None and entry.callback is not None:
            entry.callback(feedback)

    def _is_visible(self, entry: _Entry) -> bool:
        above = self._entries.get(entry.parent)
        return entry.visible and (above is None or self._is_visible(above))

    def _set(self, handle: int, what: str, value: object) -> bool:
        entry = self._entries.get(handle)
        if entry is None:
            return False
        setattr(entry, what, value)
        return True
