"""Subscriptions that a repair adds to read a sensor."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.anchors import Anchor, anchors, is_ros2
from pytest_tarl.patching.document import Document, Edit, Function, document
from pytest_tarl.patching.guards import Reading
from pytest_tarl.patching.imports import Import, import_edits, imported, reference
from pytest_tarl.patching.stores import Callback, Store, first_statement, store_edits
from pytest_tarl.patching.vocabulary import class_attributes, free, names
from pytest_tarl.sensors import Sensor
from tarl_lint.model import SiteId

if TYPE_CHECKING:
    from tarl_lint.api import Analysis

# public attributes of rclpy.node.Node, which new attributes must not replace
_NODE_ATTRIBUTES = {
    "client", "clients", "context", "default_callback_group", "executor", "guards", "handle", "publishers", "services",
    "subscriptions", "timers", "waitables",
}  # fmt: skip


@dataclass
class Subscription:
    """A subscription to add: its place, and the variables that it sets."""

    topic: str
    type: str
    anchor: Anchor
    store: Store
    names: dict[str, str] = field(default_factory=dict)  # message field → variable that stores it


class Subscriptions:
    """The subscriptions that one rewrite adds to a node."""

    def __init__(self, analysis: Analysis, topics: Mapping[str, str]) -> None:
        self._analysis = analysis
        self._topics = topics
        self._added: list[Subscription] = []
        self._taken: dict[tuple[str, bool], set[str]] = {}

    def reading(self, sensor: Sensor, site: SiteId, source: Document, place: ast.AST) -> Reading:
        """Return an expression for a sensor's value at a place. Raise RepairError."""
        subscription = self._subscription(sensor.topic or "", site, source, place)
        wanted = sensor.path
        if wanted not in subscription.names:
            subscription.names[wanted] = self._fresh(subscription.store, sensor.name)
        subscription.store.places.append(place)
        code = subscription.store.variable(subscription.names[wanted])
        return Reading(code, code)

    def edits(self) -> dict[str, list[Edit]]:
        """Return the edits that add the subscriptions, by path.

        The subscribing calls come first, because a callback may be inserted directly after the method that subscribes.
        """
        edits: dict[str, list[Edit]] = {}
        imports: dict[str, list[Import]] = {}
        callbacks: list[Callback] = []
        for each in self._added:
            source, store = each.anchor.source, each.store
            name = self._callback(each)
            line, kind = self._registration(each, name, imports.setdefault(source.path, []))
            edits.setdefault(source.path, []).append(each.anchor.edit(line))
            annotation = kind if store.source is source and each.anchor.annotated else ""
            callbacks.append(Callback(store, each.anchor, name, each.names, annotation))
        for path, edit in store_edits(callbacks):
            edits.setdefault(path, []).append(edit)
        for path, wanted in imports.items():
            edits[path] += import_edits(self._document(path), wanted)
        return edits

    def _subscription(self, topic: str, site: SiteId, source: Document, place: ast.AST) -> Subscription:
        """Return a subscription that can be read at a place, added if necessary. Raise RepairError."""
        anchor, store = self._reach(topic, site, source, place)
        for each in self._added:
            same = each.store.source is source and each.store.owner is store.owner
            if each.topic == topic and same:
                return each
        if "/" not in self._topics.get(topic, ""):
            raise RepairError(
                f"The guard must subscribe to {topic}, but the run did not show the type of its messages: let the test "
                "publish a ROS message there, or remove the sensor."
            )
        self._added.append(Subscription(topic, self._topics[topic], anchor, store))
        return self._added[-1]

    def _reach(self, topic: str, site: SiteId, source: Document, place: ast.AST) -> tuple[Anchor, Store]:
        """Return where to subscribe, and where to store values. Raise RepairError."""
        seen: Anchor | None = None
        for anchor in anchors(self._analysis, site, source.path):
            seen = seen or anchor
            if anchor.source is source:
                return anchor, _store(anchor, source, place)
            if reference(anchor.source, site.module, "") is not None:
                return anchor, Store(source, module=site.module)
        method = source.method(place)
        constructor = _constructor(method[0]) if method else None
        if seen is not None and constructor is not None and not is_ros2(seen.source):
            anchor = Anchor(source, first_statement(constructor), False, "")
            return anchor, _store(anchor, source, place)
        raise RepairError(_unreachable(topic, source, place, seen))

    def _registration(self, each: Subscription, callback: str, imports: list[Import]) -> tuple[str, str]:
        """Return the subscribing call and its message type; add the imports that it needs to `imports`."""
        source = each.anchor.source
        package, *_, name = each.type.split("/")
        kind = imported(source, f"{package}.msg", name)
        if not kind:
            free = name not in names(source)
            kind = name if free else self._fresh(Store(source), f"{name}Message")
            imports.append(Import(f"{package}.msg", name, "" if free else kind))
        topic = f"{each.anchor.quote}{each.topic}{each.anchor.quote}"
        target = self._target(each, callback, imports)
        if each.anchor.node:
            return f"{each.anchor.node}.create_subscription({kind}, {topic}, {target}, 10)", kind
        subscriber = imported(source, "rospy", "Subscriber")
        if not subscriber:
            subscriber = "rospy.Subscriber"
            imports.append(Import("rospy"))
        return f"{subscriber}({topic}, {kind}, {target})", kind

    def _target(self, each: Subscription, callback: str, imports: list[Import]) -> str:
        """Return the callback of the subscribing call; add the imports that it needs to `imports`."""
        here = each.anchor.source.method(each.anchor.statement)
        if each.store.owner is not None and here is not None:
            return f"{here[2]}.{callback}"
        found = reference(each.anchor.source, each.store.module, callback) if each.store.module else None
        if found is None:
            return callback
        imports += [found[1]] if found[1] else []
        return found[0]

    def _callback(self, each: Subscription) -> str:
        names = list(each.names.values())
        leaf = re.sub(r"\W", "_", each.topic.strip("/").rpartition("/")[2])
        base = f"on_{names[0] if len(names) == 1 else leaf}"
        return self._fresh(each.store, base, each.anchor.source)

    def _fresh(self, store: Store, base: str, *elsewhere: Document) -> str:
        """Reserve and return a name that is unused in the modules."""
        attribute = store.owner is not None
        known = [self._names(store.source, attribute)]
        if not attribute:
            known += [self._names(each, False) for each in elsewhere]
        name = free(base, set().union(*known))
        for taken in known:
            taken.add(name)
        return name

    def _names(self, source: Document, attribute: bool) -> set[str]:
        """Return the names used in a module or, with `attribute`, the attributes used in its classes."""
        key = (source.path, attribute)
        if key not in self._taken:
            self._taken[key] = self._attributes(source) if attribute else set(names(source))
        return self._taken[key]

    def _attributes(self, source: Document) -> set[str]:
        """Return all attributes of the analysed classes and of rclpy nodes."""
        names = set(_NODE_ATTRIBUTES)
        for path in self._analysis.sources:
            with suppress(RepairError):  # a file that cannot be parsed has no names
                names |= class_attributes(self._document(path))
        return names | class_attributes(source)

    def _document(self, path: str) -> Document:
        return document(path, self._analysis.sources[path])


def _store(anchor: Anchor, source: Document, place: ast.AST) -> Store:
    """Return where to store values: on the instance or in the module."""
    there, here = source.method(anchor.statement), source.method(place)
    same = there is not None and here is not None and there[0] is here[0]
    return Store(source, here[0], here[2]) if same and here else Store(source)


def _constructor(owner: ast.ClassDef) -> Function | None:
    methods = (each for each in owner.body if isinstance(each, Function))
    return next((each for each in methods if each.name == "__init__"), None)


def _unreachable(topic: str, source: Document, place: ast.AST, seen: Anchor | None) -> str:
    line = getattr(place, "lineno", 1)
    if seen is None:
        return (
            f"The guard at {source.path}:{line} must subscribe to {topic}, but no place was found where the node "
            "subscribes or starts: choose sensors that the node already reads."
        )
    return (
        f"The guard at {source.path}:{line} must subscribe to {topic}. The node subscribes at "
        f"{seen.source.path}:{seen.statement.lineno}, but that file imports nothing from {source.path}, so the "
        "value cannot reach the guard: choose sensors that the node reads in the file of the repair."
    )
