"""Check that a patched file loses only the lines that the repair changes.

The check does not rely on the positions of the edits: it parses both texts into concrete syntax trees, which include
comments.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError

if TYPE_CHECKING:
    import libcst


def nothing_lost(path: str, original: str, patched: str, changed: Collection[int]) -> None:
    """Check that all statements and comments are still there, in the same order.

    `changed` has the line numbers (from 1) of the statements that the repair rewrites; these may differ. Raise
    RepairError if the patched text does not parse, or if something is missing.
    """
    import libcst as cst
    from libcst.metadata import MetadataWrapper, PositionProvider

    try:
        before, after = MetadataWrapper(cst.parse_module(original)), cst.parse_module(patched)
    except cst.ParserSyntaxError as problem:
        raise RepairError(
            f"The repair of {path} would not parse ({problem.message}), so no patch is written."
        ) from problem
    places = before.resolve(PositionProvider)
    wanted = [
        text
        for node, text in _pieces(before.module, before.module)
        if not any(places[node].start.line <= line <= places[node].end.line for line in changed)
    ]
    kept = (text for _, text in _pieces(after, after))
    for piece in wanted:
        # `in` advances the iterator, so the pieces must occur in the same order
        if piece not in kept:
            raise RepairError(f"The repair of {path} would remove `{piece}`, so no patch is written.")


def _pieces(node: libcst.CSTNode, module: libcst.Module) -> Iterator[tuple[libcst.CSTNode, str]]:
    """Yield the code of each simple statement and comment in order."""
    import libcst as cst

    if isinstance(node, cst.Comment):
        yield node, node.value
    elif isinstance(node, cst.ImportFrom) and not isinstance(node.names, cst.ImportStar):
        for name in node.names:  # names may be added to an import
            alone = node.with_changes(
                names=[name.with_changes(comma=cst.MaybeSentinel.DEFAULT)], lpar=None, rpar=None
            )
            yield node, module.code_for_node(alone.with_changes(semicolon=cst.MaybeSentinel.DEFAULT)).strip()
    elif isinstance(node, cst.BaseSmallStatement):
        yield node, module.code_for_node(node.with_changes(semicolon=cst.MaybeSentinel.DEFAULT)).strip()
    else:
        for child in node.children:
            yield from _pieces(child, module)
