"""Analyse the data flow of a test's nodes, to find the statements to instrument."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pytest_tarl.designation import Designation
from pytest_tarl.errors import AnalysisError
from pytest_tarl.files import existing
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.item_episode import Instruments
from pytest_tarl.modules_in_flows import imported
from tarl_lint.api import Analysis, analyse
from tarl_lint.errors import ConfigError

SETTINGS = (
    ".yaml",
    ".yml",
    ".json",
    ".toml",
    ".launch",
    ".xml",
    ".cfg",
    ".ini",
)  # files with parameters or settings


def analysed(designation: Designation, folder: Path, root: Path) -> Analysis:
    """Analyse the nodes of the test in `folder`; the result names files relative to `root`.

    Raise AnalysisError if a node cannot be analysed, or if no data flows from a subscription to a publish call.
    """
    paths = []
    for node in designation.nodes:
        path = existing(folder, node)
        if path is None:
            raise AnalysisError(f"The marker names the node {node!r}: no such file in {folder}.")
        if path.suffix in SETTINGS:
            raise AnalysisError(
                f"nodes= contains {node!r}, which is not a Python file. nodes= takes only Python files of the node. "
                "A node gets the parameters of a launch file or of a parameter file that the test passes "
                "(tarl.launch, or parameters= of tarl.start), and TARL finds them there."
            )
        paths.append(path)
    with _working_in(root):  # the analysis names files relative to the working directory
        # an import from a package may lead through its __init__.py to another file
        analysis = _analysis([*paths, *imported(paths, root, packages=True)], root)
    if analysis.errors:
        first = analysis.errors[0]
        raise AnalysisError(f"{first.path}:{first.line} cannot be analysed: {first.message}")
    if not analysis.flows:
        raise AnalysisError(
            f"No flow from a subscription to a publish call was found in {', '.join(designation.nodes)}"
            f", so there is nothing to instrument: {_what_to_name(paths, folder, root)}"
        )
    return analysis


def _what_to_name(paths: Sequence[Path], folder: Path, root: Path) -> str:
    """Return the advice for nodes without a flow: name the imported files, if a flow passes through them."""
    passed = passed_with_imports(paths, root)
    if not passed:
        return "run tarl-lint on these files, and name all files of the node."
    files = ", ".join(f'"{Path(os.path.relpath(each, folder)).as_posix()}"' for each in passed)
    return f"it passes through files that are imported, so name these: nodes=[{files}]."


def passed_with_imports(paths: Sequence[Path], root: Path) -> tuple[Path, ...]:
    """Return the files that flows pass through if `paths` are analysed with the files that they import."""
    more = imported(paths, root)
    if not more:
        return ()
    with _working_in(root):
        analysis = _analysis([*paths, *more], root)
    passed = {(root / step.span.path).resolve() for step in analysis.sites}
    return tuple(each for each in (*paths, *more) if each in passed)


def _analysis(paths: Sequence[Path], root: Path) -> Analysis:
    """Analyse with the project's tarl-lint settings, which may name functions that receive or publish messages."""
    try:
        return analyse(paths, root=root, with_settings=True)
    except ConfigError as error:
        raise AnalysisError(str(error)) from error


def instruments(sites: Plan, root: Path) -> Instruments:
    """Return the positions to instrument in each file (absolute path)."""
    return Instruments({root / path: at for path, at in sites.positions.items()}, sites.publishes)


@contextmanager
def _working_in(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)
