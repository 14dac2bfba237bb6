"""Select modules by the words in their text, and group those that may share a flow."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Final, TypeVar

from tarl_lint import catalog
from tarl_lint.prefilter.programs import programs
from tarl_lint.read.module_names import Index, Named
from tarl_lint.settings.config import Config

M = TypeVar("M", bound=Named)

IMPORT: Final = re.compile(
    r"""(?:^|[;:])[ \t]*
        (?: from[ \t]+ (?P<base>[.\w][.\w \t]*?) [ \t]+ import[ \t]*
            (?: \( (?P<inside> (?: [^)#] | \#[^\n]* )* ) | (?P<members> (?: [^\n\\;\#(] | \\\n )+ ) )
          | import[ \t]+ (?P<modules> (?: [^\n\\;\#] | \\\n )+ )
        )""",
    re.VERBOSE | re.MULTILINE,
)
COMMENT: Final = re.compile(r"#[^\n]*")
PROSE: Final = re.compile(
    r"""(?P<kept> (?: [fF][rR]? | [rR][fF] ) (?: "{3}[\s\S]*?"{3} | '{3}[\s\S]*?'{3} )
          | (?! "{3} | '{3} ) (?: "(?: [^"\\\n] | \\[\s\S] )*" | '(?: [^'\\\n] | \\[\s\S] )*' )
        ) | "{3}[\s\S]*?"{3} | '{3}[\s\S]*?'{3} | \#[^\n]*""",
    re.VERBOSE,
)
DOTTED: Final = re.compile(r"(?:^|,)[\s\\(]*([.\w]+)")


def concerned(modules: Sequence[Named], config: Config) -> bool:
    """Return whether a word in any module suggests that it subscribes or publishes; if not, there is no flow."""
    return any(True for _ in mentioning(modules, config))


def relevant(modules: Sequence[M], config: Config, *, clients: bool = False) -> list[M]:
    """Return the modules that may take part in a flow, or have an unused subscription or publisher."""
    return [*{m.path: m for group in groups(modules, config, clients=clients) for m in group}.values()]


def groups(modules: Sequence[M], config: Config, *, clients: bool = False) -> list[tuple[M, ...]]:
    """Return the relevant modules in groups between which no data flows.

    A group includes everything that its modules import. With `clients`, clients of services and actions subscribe
    and publish too.

    Relevant modules are those that subscribe or publish, the modules that import these, and all imports of relevant
    modules. Within a group, a module comes after its imports, as far as import cycles allow. A module that several
    programs import may be in several groups.
    """
    start = list(mentioning(modules, config, clients=clients))
    if not start:
        return []
    index = Index(modules)
    imports = {m.path: [i for i in _imports(m, index) if i is not m] for m in modules}
    importers: dict[str, list[M]] = {m.path: [] for m in modules}
    for module in modules:
        for imported in imports[module.path]:
            importers[imported.path].append(module)
    kept = {m.path: m for m in _closure(_closure(start, importers), imports)}
    either = {p: [n for n in (*imports[p], *importers[p]) if n.path in kept] for p in kept}
    turn = {path: number for number, path in enumerate(_in_turn(kept, imports))}
    endpoints = {m.path for m in start}
    connected = (sorted(g, key=lambda m: turn[m.path]) for g in _connected(kept, either))
    return [part for group in connected for part in programs(group, imports, endpoints, code)]


def reached(start: Iterable[M], others: Sequence[M]) -> list[M]:
    """Return the modules in `others` that the modules import, directly or indirectly."""
    first = list(start)
    index = Index([*first, *others])
    wanted = {m.path for m in others}
    found: dict[str, M] = {}
    pending = first
    while pending:
        for module in _imports(pending.pop(), index):
            if module.path in wanted and module.path not in found:
                found[module.path] = module
                pending.append(module)
    return [m for m in others if m.path in found]


def mentioning(modules: Iterable[M], config: Config, *, clients: bool = False) -> Iterator[M]:
    """Yield the modules whose words suggest that they subscribe or publish. Any other module does neither."""
    has_word = endpoint_words(config, clients=clients)
    return (m for m in modules if has_word(m.text))


def endpoint_words(config: Config, *, clients: bool = False) -> Callable[[str], bool]:
    """Return a function that tests whether a text has a word that every subscribing or publishing module has."""
    named = (*(w.name for w in config.wrappers), *config.sources, *config.sinks)
    words = {*catalog.SOURCE_WORDS, *catalog.SINK_WORDS, *(name.rpartition(".")[2] for name in named)}
    words |= set(catalog.LOOKUP_WORDS) if config.tf2 else set()
    words |= set(catalog.CLIENT_WORDS) if clients or config.clients else set()
    search = re.compile("|".join(whole(word) for word in sorted(words))).search
    # checked before the pattern, because a substring search is faster and finds nothing in most files
    first = [word.rstrip("(") for word in words]

    def has_word(text: str) -> bool:
        return any(w in text for w in first) and bool(search(text)) and bool(search(code(text)))

    return has_word


@lru_cache(maxsize=512)
def code(text: str) -> str:
    """Return a file's text without comments and multi-line strings, which are mostly prose."""
    return PROSE.sub(lambda found: found["kept"] or "", text)


def whole(word: str) -> str:
    """Return a pattern for a whole word: `publish` does not match in `robot_state_publisher`."""
    return rf"\b{re.escape(word)}" + (r"\b" if word[-1].isalnum() else "")


def _closure(start: Iterable[M], edges: Mapping[str, Sequence[M]]) -> list[M]:
    found = {m.path: m for m in start}
    pending = list(found.values())
    while pending:
        for module in edges[pending.pop().path]:
            if module.path not in found:
                found[module.path] = module
                pending.append(module)
    return list(found.values())


def _connected(modules: Mapping[str, M], edges: Mapping[str, Sequence[M]]) -> Iterator[list[M]]:
    left = dict(sorted(modules.items()))
    while left:
        _, first = next(iter(left.items()))
        group = _closure([first], edges)
        for module in group:
            del left[module.path]
        yield group


def _in_turn(modules: Iterable[str], imports: Mapping[str, Sequence[Named]]) -> list[str]:
    """Return paths in an order in which each module comes after its imports."""
    done: dict[str, None] = {}
    entered: set[str] = set()
    pending = [(path, False) for path in sorted(modules, reverse=True)]
    while pending:
        path, left = pending.pop()
        if left:
            done[path] = None
        elif path not in entered:
            entered.add(path)
            pending.append((path, True))
            pending += [(m.path, False) for m in reversed(imports[path]) if m.path not in entered]
    return list(done)


def _imports(module: M, index: Index[M]) -> Iterator[M]:
    """Yield each module of the set that the given module imports, also inside functions."""
    if "import" not in module.text:
        return
    for name in dict.fromkeys(_names(module)):
        found = index.find(name, module)
        if found is not None:
            yield found


def _names(module: Named) -> Iterator[str]:
    """Yield the dotted names in import statements and in strings."""
    for statement in IMPORT.finditer(module.text):
        base, inside, members, modules = statement.groups()
        if base is None:
            yield from DOTTED.findall(modules)
            continue
        origin = _absolute(base.replace(" ", "").replace("\t", ""), module)
        yield origin
        for name in DOTTED.findall(COMMENT.sub("", inside) if inside is not None else members):
            yield f"{origin}.{name}" if origin else name


def _absolute(base: str, module: Named) -> str:
    """Return the absolute name of the module in `from base import`."""
    name = base.lstrip(".")
    level = len(base) - len(name)
    if not level:
        return base
    parts = module.name.split(".") if module.is_package else module.name.split(".")[:-1]
    kept = parts[: len(parts) - level + 1]
    return ".".join([*kept, name] if name else kept)
