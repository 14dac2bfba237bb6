"""Sums over published messages differ if a node publishes other values, or the same ones in another order."""

from __future__ import annotations

from dataclasses import dataclass

from pytest_tarl.outputs import Outputs


@dataclass
class Number:
    data: float


def sums(*messages: tuple[str, float]) -> dict[str, tuple[float, float, float]]:
    found = Outputs()
    for topic, value in messages:
        found(topic, Number(value))
    return found.sums


def test_output_checksum_depends_on_values_and_order() -> None:
    assert sums(("/a", 2.0), ("/b", 3.0), ("/a", 1.0)) == {"/a": (3.0, 5.0, 2.0), "/b": (3.0, 6.0, 3.0)}
    assert sums(("/a", 1.0), ("/b", 3.0), ("/a", 2.0)) != sums(("/a", 2.0), ("/b", 3.0), ("/a", 1.0))
    assert sums() == {}
