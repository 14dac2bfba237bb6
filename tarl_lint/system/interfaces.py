"""The interface of one program: topics and services that it uses, and its flows.

A program is analysed with the modules that it imports, whose main blocks do not run.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

from tarl_lint import engine
from tarl_lint.evidence import Outline
from tarl_lint.fingerprints import of_finding
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.model import Finding, Flow
from tarl_lint.models.ros.endpoints import Publisher
from tarl_lint.node_names import node_name
from tarl_lint.prefilter.by_words import reached
from tarl_lint.read.source import Module, Script, SourceError, parsed
from tarl_lint.settings.config import Config
from tarl_lint.system.calls import called_services
from tarl_lint.system.model import Endpoint, Interface
from tarl_lint.system.parameters import parameter_names
from tarl_lint.system.qos import of_call

_OWN: Final = "__main__"


def interface(
    script: Script, entry: str, package: str, others: Sequence[Script], config: Config
) -> Interface | str:
    """Return the interface of a program, or the reason why it cannot be analysed.

    `entry` is the function that starts it, "" for the file itself; `others` are the files that it may import.
    """
    first = parsed(script)
    if isinstance(first, SourceError):
        return f"{first.path}:{first.line}: {first.message}"
    imported = [parsed(one) for one in reached([script], others) if one.path != script.path]
    modules = [replace(first, started=(entry,) if entry else ()),
               *(_as_import(one) for one in imported if isinstance(one, Module))]  # fmt: skip
    plain = replace(config, remaps=())  # names as in the code
    machine, flows = engine.trace(modules, plain, thorough=False)
    tracer = Tracer(machine)
    endpoints = tuple(sorted(_endpoints(machine, tracer, modules), key=lambda e: (e.span, e.role)))
    return Interface(
        script.path,
        node_name(first.tree) or next((found for one in modules[1:] if (found := node_name(one.tree))), ""),
        package,
        endpoints,
        tuple(_marked(finding, flow, package, config) for finding, flow in
              zip(engine.findings(flows), flows, strict=True) if _of_topics(flow)),
        parameter_names(modules),
        not machine.cut and all(one.names for one in endpoints) and len(imported) == len(modules) - 1,
    )  # fmt: skip


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
    """Return a flow with its fingerprint of a run without launch files."""
    names = config.launched

    def named(topics: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(sorted({names.get(one.lstrip("/"), one) for one in topics}))

    source, sink = flow.source, flow.sink
    linted = replace(flow, source=replace(source, topics=named(source.topics)),
                     sink=replace(sink, topics=named(sink.topics)))  # fmt: skip
    print_ = of_finding(replace(finding, flow=linted), package, source.module)
    return replace(finding, fingerprint=print_.digest(), package=print_.package)


def _endpoints(machine: Linker, tracer: Tracer, modules: Sequence[Module]) -> Iterator[Endpoint]:
    outlines = {module.path: Outline(module.tree) for module in modules}
    for record in machine.sources.values():
        source = tracer.source(record)
        if record.kind == "topic":
            qos = of_call(outlines[record.path], record.pos) if record.api.startswith("rclpy") else None
            yield Endpoint("subscribes", source.topics, source.type, source.span, qos, source.qualname)
        elif record.kind == "service":
            yield Endpoint("serves", source.topics, source.type, source.span, None, source.qualname)
    yield from _publishers(machine, tracer, outlines)
    ran = {(frame.program.path, frame.function.qualname) for frame in machine.frames.values()}
    for module in modules:
        for call, name, kind in called_services(outlines[module.path]):
            place = outlines[module.path].qualname(call.lineno)
            if (module.path, place) in ran:
                pos = (call.lineno, call.col_offset, call.end_lineno or 0, call.end_col_offset or 0)
                yield Endpoint("calls", (name,), kind, tracer.texts[module.path].stretch(pos), None, place)


def _publishers(machine: Linker, tracer: Tracer, outlines: Mapping[str, Outline]) -> Iterator[Endpoint]:
    made: dict[tuple[str, tuple[int, int, int, int]], list[Publisher]] = {}
    for obj in machine.objects.values():
        if isinstance(obj.info, Publisher) and obj.info.kind == "topic" and obj.info.path in outlines:
            made.setdefault((obj.info.path, obj.info.pos), []).append(obj.info)
    for (path, pos), publishers in made.items():
        topics = tuple(sorted({topic for one in publishers for topic in one.topics}))
        types = " | ".join(sorted({kind for one in publishers for kind in one.types}))
        outline = outlines[path]
        qos = of_call(outline, pos) if publishers[0].api.startswith("rclpy") else None
        span = tracer.texts[path].stretch(pos)
        yield Endpoint("publishes", topics, types, span, qos, outline.qualname(pos[0]))
