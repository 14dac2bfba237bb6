"""The interface of one program: topics and services that it uses, and its flows.

A program is analysed with the modules that it imports. The main blocks of these modules do not run.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from tarl_lint import engine
from tarl_lint.evidence import Outline
from tarl_lint.fingerprints import of_finding
from tarl_lint.flows.reachability import Tracer
from tarl_lint.flows.statement_text import Texts
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.ir.lower_expressions import position
from tarl_lint.ir.nodes import Pos
from tarl_lint.model import Cut, Finding, Flow
from tarl_lint.models.ros.endpoints import Publisher, SourceRecord
from tarl_lint.node_names import node_name
from tarl_lint.parameter_names import MARK, ParameterName
from tarl_lint.prefilter.by_words import reached
from tarl_lint.read.source import Module, Script, SourceError, parsed
from tarl_lint.settings.config import Config
from tarl_lint.system.called_services import CLIENTS, called_services
from tarl_lint.system.composed_names import composed_names
from tarl_lint.system.driven import driven
from tarl_lint.system.model import Endpoint, Interface, Qos, Role
from tarl_lint.system.parameters import (
    configurations,
    deciding,
    private_words,
    reads_named_parameters,
    scopes,
    words,
)
from tarl_lint.system.qos import of_call
from tarl_lint.system.quiet_imports import closed
from tarl_lint.system.staleness import stale
from tarl_lint.system.table_rows import separated
from tarl_lint.system.unknown_fields import examined

_OWN: Final = "__main__"
_SERVED: Final[Mapping[str, Role]] = {"service": "serves", "action": "performs"}


def interface(
    script: Script,
    entry: str,
    package: str,
    others: Sequence[Script],
    config: Config,
    fixed: Mapping[str, object] = MappingProxyType({}),
) -> Interface | SourceError:
    """Return the interface of a program, or the reason why it cannot be analysed.

    `entry` is the function that starts the program; "" if the file itself is run. `others` are the files that it may
    import. `fixed` are known values of parameters.
    """
    first = parsed(script)
    if isinstance(first, SourceError):
        return first
    imported = [parsed(one) for one in reached([script], others) if one.path != script.path]
    modules = [replace(first, started=(entry,) if entry else ()),
               *(_as_import(one) for one in imported if isinstance(one, Module))]  # fmt: skip
    # analyse without remappings, so that names stay as they are in the code
    plain = replace(config, remaps=())
    parameters: list[ParameterName] = []
    machine, flows = engine.trace(modules, plain, thorough=False, parameters=parameters, fixed=fixed)
    tracer = Tracer(machine)
    outlines = {module.path: Outline(module.tree) for module in modules}
    # texts of all modules, even if none of their code runs
    texts = Texts({module.path: module for module in modules})
    calls = (end for each in modules for end in _clients(machine, each, outlines[each.path], texts))
    found = tuple(
        _marked(finding, flow, package, config)
        for finding, flow in zip(engine.findings(flows), flows, strict=True)
        if not {"tf2", ""} & {flow.source.api.partition(".")[0], flow.sink.api.partition(".")[0]}
    )
    ends = (*_endpoints(machine, tracer, outlines, driven(machine, found, modules)), *calls)
    endpoints = tuple(sorted(dict.fromkeys(ends), key=lambda e: (e.span, e.role, e.names)))
    imports_read = len(imported) == len(modules) - 1
    quiet = closed(modules) and imports_read
    named = all(one.names for one in endpoints) and not any(topicless(one) for one in flows)
    heard = _heard(machine)
    fields = [examined(each, outlines[each.path], texts, heard) for each in modules]
    configured, exact = configurations(modules), composed_names(machine, modules, outlines)
    private, public = scopes(modules)
    return Interface(
        path=script.path,
        name=next((name for one in modules if (name := node_name(one.tree))), ""),
        package=package,
        endpoints=endpoints,
        flows=found,
        words=words(modules),
        private_words=private_words(modules),
        parameters=closed(modules, of_parameters=True)
        and imports_read
        and configured is not None
        and (exact is not None or reads_named_parameters(modules)),
        exact=exact,
        closed=quiet,
        whole=quiet and named and not machine.cut,
        complete=quiet and not machine.cut,
        cut=tuple(sorted(_cut(machine, modules))),
        private=private,
        public=public,
        stale=stale(found, modules),
        deciding=deciding(modules),
        in_names=tuple(parameters),
        misfits=tuple(one for absent, _ in fields for one in absent),
        configured=configured or (),
        uses=tuple(one for _, unknown in fields for one in unknown),
    )


def _cut(machine: Linker, modules: Iterable[Module]) -> Iterator[Cut]:
    """Yield the parts of a program that exhausted the budget."""
    for one in modules:
        if one.path in machine.cut:
            yield Cut(one.path, node_name(one.tree))


def _heard(machine: Linker) -> Mapping[str, frozenset[str]]:
    """Return the types of the messages that subscriptions pass to each callback, by the last part of its name.

    Callbacks that receive messages of an unknown type are left out.
    """
    found: dict[str, set[str]] = {}
    for record in machine.sources.values():
        if record.kind == "topic":
            for name in record.callbacks:
                found.setdefault(name.rpartition(".")[2], set()).update(record.whole_types or {""})
    return {name: frozenset(kinds) for name, kinds in found.items() if "" not in kinds}


def topicless(flow: Flow) -> bool:
    """Return whether an end of a flow between topics has no constant name."""
    return _of_topics(flow) and not (flow.source.topics and flow.sink.topics)


def _as_import(module: Module) -> Module:
    """Return a module without its main block and entry points."""
    body = [one for one in module.tree.body if not _main_block(one)]
    tree = ast.Module(body=body, type_ignores=[])
    return replace(module, tree=tree, started=(), installed=True)


def _main_block(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If) and any(
        isinstance(one, ast.Constant) and one.value == _OWN for one in ast.walk(statement.test)
    )


def _of_topics(flow: Flow) -> bool:
    return "publish" in flow.sink.api.lower() and "ubscri" in flow.source.api


def _marked(finding: Finding, flow: Flow, package: str, config: Config) -> Finding:
    """Return a flow with its fingerprint from a run without launch files."""
    names = config.launched

    def named(topics: tuple[str, ...]) -> tuple[str, ...]:
        if any(MARK in one for one in topics):
            return ()  # without a launch file, the parameter and the name are unknown
        return tuple(sorted({names.get(one.lstrip("/"), one) for one in topics}))

    source, sink = flow.source, flow.sink
    linted = replace(flow, source=replace(source, topics=named(source.topics)),
                     sink=replace(sink, topics=named(sink.topics)))  # fmt: skip
    print_ = of_finding(replace(finding, flow=linted), package, source.module)
    return replace(finding, fingerprint=print_.digest(), package=print_.package)


def _endpoints(
    machine: Linker, tracer: Tracer, outlines: Mapping[str, Outline], driving: Collection[tuple[str, Pos]]
) -> Iterator[Endpoint]:
    for record in machine.sources.values():
        source = tracer.ends.source(record)
        if record.kind == "topic":
            whole = only(record.whole_types)
            end = Endpoint(
                "subscribes", source.topics, source.type, source.span, None, source.qualname, whole_type=whole
            )
            for one in separated(end, record.whole_types, outlines.values()):
                yield replace(one, qos=_profile(record, one.names, outlines))
        elif record.kind in _SERVED and not record.api.startswith(CLIENTS):
            role = _SERVED[record.kind]
            whole = imported_type(outlines[record.path].tree, source.type)
            yield Endpoint(
                role, source.topics, source.type, source.span, None, source.qualname, whole_type=whole
            )
    yield from _publishers(machine, tracer, outlines, driving)


def _profile(
    made: SourceRecord | Publisher, topics: Collection[str], outlines: Mapping[str, Outline]
) -> Qos | None:
    """Return the quality of service of a publisher or subscription of rclpy; None if it is not constant."""
    if not made.api.startswith(("rclpy", "message_filters")):
        return None
    via = made.via if isinstance(made, SourceRecord) else ()
    inside = [(outlines[path], pos) for path, pos in via if path in outlines]
    return of_call(outlines[made.path], made.pos, outlines.values(), topics, inside)


def _clients(machine: Linker, module: Module, outline: Outline, texts: Texts) -> Iterator[Endpoint]:
    """Yield the services and actions that a module calls."""
    ran = {frame.function.qualname for frame in machine.frames.values() if frame.program.path == module.path}
    made = _made(machine, "service", [module.path])
    asking = _made(machine, "action", [module.path])
    for (_, pos), clients in (*made.items(), *asking.items()):
        role: Role = "asks" if clients[0].kind == "action" else "calls"
        names = tuple(sorted({topic for one in clients for topic in one.topics}))
        kind = " | ".join(sorted({kind for one in clients for kind in one.types}))
        if names:
            span = texts[module.path].stretch(pos)
            whole = imported_type(module.tree, kind)
            yield Endpoint(role, names, kind, span, None, outline.qualname(pos[0]), whole_type=whole)
    for call, name, kind in called_services(outline):
        place = outline.qualname(call.lineno)
        known = any(one.topics for one in made.get((module.path, position(call)), []))
        if not known and (not ran or place in ran or not place):
            span, whole = texts[module.path].stretch(position(call)), imported_type(module.tree, kind)
            yield Endpoint("calls", (name,), kind, span, None, place, whole_type=whole)


def _publishers(
    machine: Linker, tracer: Tracer, outlines: Mapping[str, Outline], driving: Collection[tuple[str, Pos]]
) -> Iterator[Endpoint]:
    made = _made(machine, "topic", outlines)
    for (path, pos), publishers in ((at, alike) for at, every in made.items() for alike in _by_topics(every)):
        topics = tuple(sorted({topic for one in publishers for topic in one.topics}))
        types = " | ".join(sorted({kind for one in publishers for kind in one.types}))
        whole = {kind for one in publishers for kind in one.whole_types}
        span, place = tracer.texts[path].stretch(pos), outlines[path].qualname(pos[0])
        end = Endpoint("publishes", topics, types, span, None, place, whole_type=only(whole))
        for one in separated(end, whole, outlines.values()):
            profile = _profile(publishers[0], one.names, outlines)
            yield replace(one, qos=profile, driven=(path, pos) in driving)


def _made(machine: Linker, kind: str, paths: Collection[str]) -> dict[tuple[str, Pos], list[Publisher]]:
    """Return the publishers or clients that modules make, by file and position."""
    made: dict[tuple[str, Pos], list[Publisher]] = {}
    for obj in machine.objects.values():
        if isinstance(obj.info, Publisher) and obj.info.kind == kind and obj.info.path in paths:
            made.setdefault((obj.info.path, obj.info.pos), []).append(obj.info)
    return made


def imported_type(tree: ast.Module, name: str) -> str:
    """Return `package/Name` of an imported service or action type; else ""."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            package, _, rest = node.module.partition(".")
            if rest in ("srv", "action") and name in [one.name for one in node.names if one.asname is None]:
                return f"{package}/{name}"
    return ""


def _by_topics(publishers: Sequence[Publisher]) -> Iterable[list[Publisher]]:
    """Return the publishers of one place, grouped by their topics."""
    groups: dict[frozenset[str], list[Publisher]] = {}
    for one in publishers:
        groups.setdefault(frozenset(map(str, one.topics)), []).append(one)
    return groups.values()


def only(types: Collection[str]) -> str:
    """Return the type if there is exactly one; else ""."""
    return next(iter(types)) if len(types) == 1 else ""
