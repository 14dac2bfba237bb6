"""API for other programs: flows, sites, the operands of a site, and expressions that contain a field of a topic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from tarl_lint import engine
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.model import Flow, Operand, SiteId, Step
from tarl_lint.queries.probe import Prober
from tarl_lint.read import discover
from tarl_lint.read.discover import SourceFile
from tarl_lint.read.source import Module, SourceError, parse
from tarl_lint.settings.config import Config, describing


@dataclass(frozen=True, eq=False)
class Analysis:
    """The result of analysing a set of files. `sources` maps paths to texts."""

    flows: tuple[Flow, ...]
    errors: tuple[SourceError, ...]
    sources: Mapping[str, str]
    machine: Linker = field(repr=False)

    @cached_property
    def sites(self) -> tuple[Step, ...]:
        """Return every distinct data or control step, sorted by path, line and column."""
        found: dict[SiteId, Step] = {}
        for flow in self.flows:
            for step in flow.steps:
                if step.dependence == "context":
                    continue
                known = found.get(step.site)
                if known is None or (known.dependence == "control" and step.dependence == "data"):
                    found[step.site] = step
        return tuple(sorted(found.values(), key=lambda s: s.span))

    @cached_property
    def prober(self) -> Prober:
        """Return the prober, which runs the analysis again to observe single statements."""
        return Prober(self.machine, self.flows)

    @property
    def timing(self) -> tuple[Step, ...]:
        """Return the statements that wait or set a rate but are on no flow, sorted by position."""
        return tuple(sorted(self.prober.timing.values(), key=lambda s: s.span))

    @property
    def deciding(self) -> tuple[Step, ...]:
        """Return the statements that decide what is published but are on no flow, sorted by position."""
        return tuple(sorted(self.prober.deciding.values(), key=lambda s: s.span))

    @property
    def configuring(self) -> Mapping[SiteId, tuple[Step, tuple[SiteId, ...]]]:
        """Return the statements outside the flows that fill an object with constants, and the sites that use it.

        One example is `self.pid = PID(1.0, 0.1, 0.0)` if a statement of a flow calls `self.pid(…)`. Another one is
        `GAINS = [0.5, 2.0]` if a statement of a flow iterates over GAINS.
        """
        return self.prober.configuring

    @property
    def making(self) -> Mapping[SiteId, tuple[Step, tuple[SiteId, ...]]]:
        """Return the statements outside the flows that pass constants to objects of the program's own classes.

        An example is `self.left = Wheel(0.16)`; `limited = partial(clamp, high=0.8)` counts, too. Each statement comes
        with the sites that use the object.
        """
        return self.prober.making

    def operands(self, site: SiteId) -> tuple[Operand, ...]:
        """Return the constants that a site uses, in source order."""
        return self.prober.operands(site)

    def holders(self, topic: str, field: str, site: SiteId) -> tuple[str, ...]:
        """Return the expressions at a site that contain the unchanged value of a field of a topic, shortest first."""
        return self.prober.holders(topic, field, site)


def analyse(paths: Sequence[Path], *, root: Path | None = None, with_settings: bool = False) -> Analysis:
    """Analyse the files at and below the paths.

    `root` is the base of relative paths in settings; it defaults to the working directory. `with_settings` applies
    those settings of the nearest settings file that describe the code, such as the functions that receive messages.
    Raises UsageError for a path that does not exist, and ConfigError for an unusable settings file.
    """
    config = describing(paths, root) if with_settings else Config(root=root)
    files = discover.find(paths, config).files
    parsed = [_read(file) for file in files]
    modules = [p for p in parsed if isinstance(p, Module)]
    machine, flows = engine.trace(modules, config)
    return Analysis(
        flows=flows,
        errors=tuple(p for p in parsed if isinstance(p, SourceError)),
        sources={m.path: m.text for m in modules},
        machine=machine,
    )


def _read(file: SourceFile) -> Module | SourceError:
    try:
        data = file.path.read_bytes()
    except OSError as error:
        return SourceError(file.shown, 1, f"The file cannot be read: {error.strerror or error}.")
    found = parse(file.shown, data, file.name)
    return replace(found, started=file.started) if isinstance(found, Module) and file.started else found
