"""Objects of a node with `__del__` are finalized when the episode ends."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from pytest_tarl.finalizers import run_finalizers


class Cyclic:
    """An object of a node, in a reference cycle, that notes when it is finalized."""

    def __init__(self, ended: list[str]) -> None:
        self.ended = ended
        self.callback = self.finish

    def finish(self) -> None:
        """Refer to the object."""

    def __del__(self) -> None:
        self.ended.append("finalized")


@pytest.mark.parametrize(
    ("text", "expected"),
    [("class Node:\n    def __del__(self):\n        pass\n", ["finalized"]), ("class Node:\n    pass\n", [])],
)
def test_garbage_is_collected_if_a_node_defines_a_finalizer(
    text: str, expected: list[str], tmp_path: Path
) -> None:
    node = tmp_path / "node.py"
    node.write_text(text)
    ended: list[str] = []
    gc.collect()
    gc.disable()
    try:
        Cyclic(ended)
        run_finalizers([tmp_path / "missing.py", node])
        assert ended == expected
    finally:
        gc.enable()
        gc.collect()
