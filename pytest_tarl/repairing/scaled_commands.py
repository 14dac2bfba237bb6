"""Constants whose change has the same effect as a factor on a whole command.

A factor before the publish call can hide which number of the command is too small. For example, on carpet only the
smallest turning speed is too small, and a maintainer would change this number.
"""

from __future__ import annotations

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import document
from pytest_tarl.patching.mutate import form_values
from pytest_tarl.patching.written_by import writers
from pytest_tarl.searching.constants_first import Scaled
from pytest_tarl.searching.search import Candidate
from tarl_lint.api import Analysis

GAIN = "gain"  # name of the parameter of templates that scale a command and have no other parameter


def scaled_command(analysis: Analysis, candidate: Candidate) -> Scaled | None:
    """If a change scales a command, return the factor and the statements that compute the command, nearest first."""
    if len(candidate.mutations) != 1:
        return None
    (mutation,) = candidate.mutations
    form, span = mutation.form, mutation.operand.span
    if form is None or form.template.state or [one.name for one in form.template.parameters] != [GAIN]:
        return None
    try:
        source = document(span.path, analysis.sources[span.path])
        node = source.find(span)
    except (RepairError, KeyError):
        return None
    statements = [source.statement(node), *writers(source, node, form.target(source.source(node)))]
    lines = [(span.path, one.lineno, one.end_lineno or one.lineno) for one in statements]
    return Scaled(form_values(mutation)[GAIN], tuple(dict.fromkeys(lines)))
