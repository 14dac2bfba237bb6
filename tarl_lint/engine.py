"""Compute flows and findings from modules and settings.

The analysis is a pure function: the same files give the same result everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

from tarl_lint.evidence import Evidence
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.model import RULES, Cut, Finding, Flow
from tarl_lint.node_names import node_name
from tarl_lint.parameter_names import ParameterName
from tarl_lint.prefilter.by_words import groups, relevant
from tarl_lint.prefilter.one_sided_groups import Rule, one_sided
from tarl_lint.read.source import Module
from tarl_lint.read.watched import Reading, watched
from tarl_lint.rules import tarl101, tarl102, tarl103
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.run.gc_paused import without_collection
from tarl_lint.settings.config import Config

HAZARDS: Final = tuple(
    cast("Rule", import_module(f"tarl_lint.rules.{code.lower()}"))
    for code in RULES
    if code.startswith("TARL2")
)


def lint(modules: Sequence[Module], config: Config) -> tuple[Finding, ...]:
    """Return every finding: flows, and hazards of the enabled rules."""
    found = (f for group in groups(modules, config) for f in examine(group, config)[0])
    return tuple(dict.fromkeys(found))


def examine(
    modules: Sequence[Module],
    config: Config,
    *,
    isolate: bool = False,
    readings: dict[str, Reading] | None = None,
) -> tuple[tuple[Finding, ...], dict[str, Exception], tuple[Cut, ...], tuple[str, ...]]:
    """Return the findings in a group of modules, the failures by file, and the programs that exhausted their budget.

    The last element of the result lists the classes outside the files at which flows ended.

    With `isolate`, code that makes the analysis fail is treated as if it did nothing, and the rest is analysed.
    Otherwise, failures are raised. If `readings` is given, the parts that the analysis reads of each file are
    stored there.
    """
    if one_sided(modules, config, HAZARDS):
        return (), {}, (), ()
    observed = [watched(m) for m in modules] if readings is not None else []
    modules = observed or modules
    failures: dict[str, Exception] | None = {} if isolate else None
    with without_collection():
        found, cut, ended = with_deep_stack(lambda: _found(modules, config, failures))
    if readings is not None:
        readings.update((module.path, module.reading()) for module in observed)
    return found, failures or {}, cut, ended


def _found(
    modules: Sequence[Module], config: Config, failures: dict[str, Exception] | None
) -> tuple[tuple[Finding, ...], tuple[Cut, ...], tuple[str, ...]]:
    machine = Linker(modules, config, failures, thorough=False)
    machine.link()
    tracer = Tracer(machine)
    flows = tracer.flows()
    found = (*findings(flows), *hazards(tracer, flows, config))
    tracer.texts.release()
    machine.release()
    ended = tuple(sorted(machine.ended))
    trees = {module.path: module.tree for module in modules}
    cut = sorted(Cut(path, node_name(trees[path])) for path in machine.cut if path in trees)
    return found, tuple(cut), ended


def analyse(modules: Sequence[Module], config: Config) -> tuple[Flow, ...]:
    """Return every flow, sorted by publish call and subscription."""
    return trace(modules, config, thorough=False)[1]


def trace(
    modules: Sequence[Module],
    config: Config,
    *,
    thorough: bool = True,
    parameters: list[ParameterName] | None = None,
    fixed: Mapping[str, object] = MappingProxyType({}),
) -> tuple[Linker, tuple[Flow, ...]]:
    """Return the flows and the interpreter that found them. A thorough interpreter can answer further queries.

    With `parameters`, topic names may contain parameters. The analysis appends each parameter to this list, and a
    topic name refers to it by its index in the list. `fixed` are the values of parameters; DEFAULT stands for the
    default in the code.
    """

    def linked() -> tuple[Linker, tuple[Flow, ...]]:
        launched = parameters is not None
        machine = Linker(
            relevant(modules, config, clients=launched or config.clients), config, thorough=thorough
        )
        machine.parameter_names, machine.fixed = parameters, fixed
        machine.link()
        return machine, Tracer(machine).flows()

    with without_collection():
        return with_deep_stack(linked)


def findings(flows: Sequence[Flow]) -> tuple[Finding, ...]:
    """Return one finding per flow, at the publish call."""
    return tuple(_finding(flow) for flow in flows)


def _finding(flow: Flow) -> Finding:
    if tarl103.own_response(flow):
        return tarl103.finding(flow)
    return tarl101.finding(flow) if flow.kind == "explicit" else tarl102.finding(flow)


def hazards(tracer: Tracer, flows: Sequence[Flow], config: Config) -> tuple[Finding, ...]:
    """Return the hazards of the enabled rules."""
    wanted = [rule for rule in HAZARDS if config.enabled(rule.CODE)]
    if not wanted or not tracer.machine.modules:
        return ()
    evidence = Evidence(tracer, flows)
    found = {finding for rule in wanted for finding in rule.findings(evidence)}
    return tuple(sorted(found, key=lambda f: (f.span, f.code, f.message)))
