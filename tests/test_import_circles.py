"""Only modules that mirror classes of rclpy with mutual references import each other."""

from __future__ import annotations

from collections.abc import Iterator

import grimp
import pytest

MIRRORED = ("pytest_tarl.ros.rclpy", "pytest_tarl.ros.rclpy.action")


def circles(imports: dict[str, set[str]]) -> Iterator[frozenset[str]]:
    """Yield the sets of modules that import each other, directly or indirectly (Tarjan 1972)."""
    number: dict[str, int] = {}
    lowest: dict[str, int] = {}
    path: list[str] = []

    def visit(module: str) -> Iterator[frozenset[str]]:
        number[module] = lowest[module] = len(number)
        path.append(module)
        for other in sorted(imports.get(module, ())):
            if other not in number:
                yield from visit(other)
                lowest[module] = min(lowest[module], lowest[other])
            elif other in path:
                lowest[module] = min(lowest[module], number[other])
        if lowest[module] == number[module]:
            members = path[path.index(module) :]
            del path[path.index(module) :]
            if len(members) > 1:
                yield frozenset(members)

    for module in sorted(imports):
        if module not in number:
            yield from visit(module)


@pytest.mark.parametrize(
    ("imports", "found"),
    [
        ({"a": {"b"}, "b": {"c"}, "c": set()}, []),
        ({"a": {"b"}, "b": {"a"}, "c": {"a"}}, [{"a", "b"}]),
        ({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}}, [{"d", "e"}, {"a", "b", "c"}]),
    ],
)
def test_import_cycles_are_found(imports: dict[str, set[str]], found: list[set[str]]) -> None:
    assert list(circles(imports)) == found


def test_only_modules_that_mirror_rclpy_are_in_import_cycles() -> None:
    graph = grimp.build_graph("tarl_lint", "pytest_tarl", cache_dir=None)
    imports = {module: set(graph.find_modules_directly_imported_by(module)) for module in graph.modules}
    rooms = sorted(sorted({module.rpartition(".")[0] for module in one}) for one in circles(imports))
    assert rooms == [[room] for room in MIRRORED]
