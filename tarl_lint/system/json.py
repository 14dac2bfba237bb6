"""JSON report of systems, frozen in `system.schema.json`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from tarl_lint import __version__
from tarl_lint.files import shown
from tarl_lint.model import Finding
from tarl_lint.report.json import extent, statement
from tarl_lint.system.flow_chains import chains
from tarl_lint.system.model import Endpoint, Hop, Instance, System
from tarl_lint.system.one_sided_names import OneSided, one_sided
from tarl_lint.workspace.launch_model import Setting

FORMAT_VERSION: Final = 1  # 1: first format


OfFlow = Callable[[Finding], Mapping[str, Any]]


def document(
    systems: Sequence[System], origin: str = "", target: str = "", of_flow: OfFlow | None = None
) -> dict[str, Any]:
    """Return all systems in the frozen order of keys. `of_flow` returns the statements of a flow."""
    return {
        "format": FORMAT_VERSION,
        "tool": {"name": "tarl-lint", "version": __version__},
        "systems": [_system(one, origin, target, of_flow or _statements) for one in systems],
    }


def _system(system: System, origin: str, target: str, of_flow: OfFlow) -> dict[str, Any]:
    found, more = chains(system.hops, origin, target)
    lonely = [_one_sided(one) for one in one_sided(system)]
    numbers = {id(hop): number for number, hop in enumerate(system.hops)}
    return {
        "launch": shown(system.file),
        "arguments": dict(system.arguments),
        "nodes": [_node(one) for one in system.instances],
        "parameters": [_parameter(one) for one in system.settings if not one.unknown],
        "hops": [_hop(one, of_flow) for one in system.hops],
        "chains": [{"kind": one.kind, "hops": [numbers[id(hop)] for hop in one.hops]} for one in found],
        "more_chains": more,
        "diagnostics": [_finding(one) for one in system.findings],
        "unknown": [
            {"path": shown(one.file), "line": one.line, "reason": one.reason} for one in system.problems
        ],
        **({"one_sided": lonely} if lonely else {}),
    }


def _node(instance: Instance) -> dict[str, Any]:
    node, interface = instance.node, instance.interface
    return {
        "name": instance.name,
        "namespace": node.namespace,
        "kind": node.kind,
        "package": node.package,
        "executable": node.executable,
        "path": shown(node.file),
        "line": node.line,
        "condition": node.condition,
        "program": interface.path if interface is not None else None,
        "not_read": None if interface is not None else instance.unread,
        "remaps": [{"from": old, "to": new} for old, new in node.remaps],
        "parameters": [_parameter(one) for one in node.settings if not one.unknown],
        **{role: [_end(name, end) for name, end in instance.named(role)]
           for role in ("subscribes", "publishes", "serves", "calls")},
        "touches": list(instance.touched),
    }  # fmt: skip


def _end(name: str, end: Endpoint) -> dict[str, Any]:
    return {"name": name, "in_code": list(end.in_code), "type": end.type, **extent(end.span)}


def _parameter(setting: Setting) -> dict[str, Any]:
    return {"name": setting.name, "value": setting.value, "yaml": setting.yaml, "path": shown(setting.file)}


def _hop(hop: Hop, of_flow: OfFlow) -> dict[str, Any]:
    return {
        "node": hop.node,
        "from": hop.source,
        "to": hop.sink,
        "kind": hop.kind,
        "flows": [
            {
                "fingerprint": one.fingerprint,
                "kind": one.flow.kind,
                "source": one.flow.source.id,
                "sink": one.flow.sink.id,
                **of_flow(one),
            }
            for one in hop.findings
            if one.flow is not None
        ],
    }


def _statements(finding: Finding) -> Mapping[str, Any]:
    return {"steps": [statement(each) for each in finding.flow.steps] if finding.flow is not None else []}


def _one_sided(one: OneSided) -> dict[str, Any]:
    return {
        "name": one.name,
        "missing": one.missing,
        "types": list(one.types),
        "nodes": list(one.users),
        "certain": one.certain,
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "code": finding.code,
        **extent(finding.span),
        "message": finding.message,
        "fingerprint": finding.fingerprint,
        "status": finding.status,
    }
