"""Modules and settings become flows and findings. Pure: the same files give the same answer everywhere."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Final

from tarl_lint.config import Config
from tarl_lint.evidence import Evidence
from tarl_lint.model import Finding, Flow
from tarl_lint.relevance import relevant
from tarl_lint.rules import tarl101, tarl102, tarl201, tarl202, tarl203, tarl204
from tarl_lint.source import Module
from tarl_lint.taint import Tracer
from tarl_lint.valueflow.link import Linker

HAZARDS: Final = (tarl201, tarl202, tarl203, tarl204)


def lint(modules: Sequence[Module], config: Config) -> tuple[Finding, ...]:
    """Return every finding: flows, and hazards of the rules that are wanted."""
    machine, flows = trace(modules, config)
    return (*findings(flows), *hazards(machine, flows, config))


def analyse(modules: Sequence[Module], config: Config) -> tuple[Flow, ...]:
    """Return every flow, sorted by publish call and subscription."""
    return trace(modules, config)[1]


def trace(modules: Sequence[Module], config: Config) -> tuple[Linker, tuple[Flow, ...]]:
    """Return the flows and the machine that found them, which can be asked more."""
    machine = Linker(relevant(sorted(modules, key=lambda m: m.path), config), config)
    with _without_collection():
        machine.link()
        flows = Tracer(machine).flows()
    return machine, flows


def findings(flows: Sequence[Flow]) -> tuple[Finding, ...]:
    """Return one finding per flow, at the publish call."""
    return tuple(
        tarl101.finding(flow) if flow.kind == "explicit" else tarl102.finding(flow) for flow in flows
    )


def hazards(machine: Linker, flows: Sequence[Flow], config: Config) -> tuple[Finding, ...]:
    """Return what is wrong or risky rather than merely there, of the rules that are wanted."""
    wanted = [rule for rule in HAZARDS if config.enabled(rule.CODE)]
    if not wanted or not machine.modules:
        return ()
    evidence = Evidence(machine, flows)
    found = {finding for rule in wanted for finding in rule.findings(evidence)}
    return tuple(sorted(found, key=lambda f: (f.span, f.code, f.message)))


@contextmanager
def _without_collection() -> Iterator[None]:
    """Keep the garbage collector from walking the live trees again and again."""
    active = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if active:
            gc.enable()
