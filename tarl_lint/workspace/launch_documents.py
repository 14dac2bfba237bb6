"""Parse launch files in XML and YAML into elements with lines. XML entities and YAML tags are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.launch_entities import Entity
from tarl_lint.workspace.model import Problem, unreadable

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)
MOST: Final = 5_000  # maximum number of elements of a file
LINE: Final = "\0line"  # key of the line; no XML attribute can have this name
_LISTS: Final = (
    "launch",
    "group",
    "timer",
)  # YAML keys with a list of elements; each element maps its tag


def xml_tree(text: str) -> Element:
    """Parse XML and return the root element; each element has its line in the attribute `LINE`.

    Raises UnreadableError for entities, ExpatError for invalid XML.
    """
    builder, parser = TreeBuilder(), expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        builder.start(tag, {**attributes, LINE: str(parser.CurrentLineNumber)})

    def refuse(*_: Any) -> None:
        raise UnreadableError("it declares entities")

    parser.StartElementHandler, parser.EndElementHandler = start, builder.end
    parser.CharacterDataHandler, parser.EntityDeclHandler = builder.data, refuse
    parser.Parse(text.encode(), True)
    return builder.close()


def xml_root(path: Path, problems: list[Problem]) -> Element | None:
    """Return the root element of a file; if the file cannot be read, record a problem and return None."""
    try:
        return xml_tree(read_text(path, LARGEST))
    except UnreadableError as reason:
        problems.append(unreadable(path, 0, str(reason)))
    except (expat.ExpatError, AssertionError) as error:
        problems.append(unreadable(path, getattr(error, "lineno", 0), f"it is not XML: {error}"))
    return None


def of_xml(element: Element) -> list[Entity]:
    """Return the elements below an XML element."""
    return [
        Entity(
            one.tag.replace("-", "_"),
            int(one.get(LINE, "0")),
            {key: value for key, value in one.attrib.items() if key != LINE},
            of_xml(one),
        )
        for one in element
    ]


def of_yaml(path: Path, problems: list[Problem]) -> list[Entity]:
    """Return the elements of a YAML launch file."""
    try:
        import yaml
    except ModuleNotFoundError:
        problems.append(unreadable(path, 0, "reading YAML needs PyYAML: run pip install PyYAML"))
        return []
    try:
        root = yaml.compose(read_text(path, LARGEST), Loader=yaml.SafeLoader)
    except UnreadableError as reason:
        problems.append(unreadable(path, 0, str(reason)))
        return []
    except (yaml.YAMLError, RecursionError) as error:
        problems.append(unreadable(path, 0, f"it is not YAML: {' '.join(str(error).split())[:200]}"))
        return []
    launch = next((value for key, value in _pairs(root) if key.value == "launch"), None)
    if launch is None:
        problems.append(unreadable(path, 0, "it is not a launch file: it has no `launch:`"))
        return []
    return _named(launch, [MOST])


def _pairs(node: Any) -> list[tuple[Any, Any]]:
    """Return the keys and values of a YAML node; empty if it is not a mapping."""
    return node.value if node is not None and node.id == "mapping" else []


def _named(node: Any, left: list[int]) -> list[Entity]:
    """Return the elements of a list of mappings. Each mapping has a single key, which is the tag."""
    found: list[Entity] = []
    for one in node.value if node.id == "sequence" else ():
        for key, value in _pairs(one):
            left[0] -= 1
            if left[0] >= 0:
                found.append(_entity(str(key.value), value, key.start_mark.line + 1, left))
    return found


def _entity(tag: str, node: Any, line: int, left: list[int]) -> Entity:
    entity = Entity(tag.replace("-", "_"), line)
    if isinstance(node.value, str):
        return entity
    if node.id == "sequence":
        entity.children = _named(node, left)
        return entity
    for key, value in _pairs(node):
        name = str(key.value)
        if isinstance(value.value, str):
            entity.attributes[name.replace("-", "_") if name not in ("if",) else name] = value.value
        elif name == "children" or (value.id == "sequence" and entity.tag in _LISTS):
            entity.children += _named(value, left)
        elif name == "value":
            entity.attributes[name] = _flow(value, left)
        elif value.id == "sequence":
            for item in value.value:
                left[0] -= 1
                if left[0] >= 0 and item.id == "mapping":
                    entity.children.append(_entity(name, item, item.start_mark.line + 1, left))
    return entity


def _flow(node: Any, left: list[int]) -> str:
    """Return a list in a parameter value as YAML text."""
    left[0] -= 1
    if left[0] < 0:
        return ""
    if isinstance(node.value, str):
        return node.value
    parts = node.value if node.id == "sequence" else [key for key, _ in _pairs(node)]
    return f"[{', '.join(_flow(one, left) for one in parts)}]"
