"""All bounds on means and rates come from learning/bounds.py, which documents their assumptions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import pytest_tarl

PACKAGE = Path(pytest_tarl.__file__).parent
PARTS = {"student", "shifts", "binomial"}  # modules that only bounds.py may use
HOME = {f"learning/{name}.py" for name in (*PARTS, "bounds")}
DIRECTIONS = {
    "stressing/spreading.py"
}  # turns numbers into directions by normal quantiles, without an interval
NO_INTERVALS = {  # findings of the check that are no parts of an interval
    "searching/laws.py": ["1.28"],  # a ratio of powers, about 1.13 squared
    "stressing/loss_noise.py": ["the spread of a mean"],  # precision of paired and unpaired tests
}
QUANTILES = {
    "NormalDist",
    "inv_cdf",
    "ppf",
    "isf",
    "sem",
    "student_quantile",
    "mean_bounds",
    "confidence_interval",
}
LIBRARIES = {"scipy", "statsmodels", "confseq"}
SPREADS = {"std", "stdev", "var", "variance"}
COUNTS = {"len", "size", "sqrt"}
NORMAL = (1.28, 1.64, 1.645, 1.96, 2.33, 2.576, 2.58)  # well-known quantiles of the normal distribution


def names(tree: ast.AST) -> set[str]:
    return {
        node.id if isinstance(node, ast.Name) else node.attr
        for node in ast.walk(tree)
        if isinstance(node, (ast.Name, ast.Attribute))
    }


def computed(source: str) -> Iterator[str]:
    """Yield signs that a module computes an interval: quantiles, statistics libraries, standard errors, our parts."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            module = node.module or ""
            parts = {module.rpartition(".")[2], *(alias.name for alias in node.names)}
            if module.startswith("pytest_tarl.learning") and parts & PARTS:
                yield f"line {node.lineno}: a part of bounds.py"
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            first = {alias.name for alias in node.names} | {getattr(node, "module", None) or ""}
            found = {one.partition(".")[0] for one in first} & LIBRARIES | first & QUANTILES
            if found:
                yield f"line {node.lineno}: {', '.join(sorted(found))}"
        if isinstance(node, ast.Attribute) and node.attr in QUANTILES:
            yield f"line {node.lineno}: {node.attr}"
        if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value in NORMAL:
            yield f"line {node.lineno}: {node.value}"
        divided = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)
        if divided and names(node.left) & SPREADS and names(node.right) & COUNTS:
            yield f"line {node.lineno}: the spread of a mean"


@pytest.mark.parametrize(
    "source",
    [
        "from pytest_tarl.learning.student import mean_bounds",
        "from pytest_tarl.learning import student",
        "from statistics import NormalDist",
        "import scipy.stats",
        "from scipy.stats import t",
        "reach = stats.t.ppf(0.975, 7)",
        "low = mean - 1.96 * error",
        "error = values.std(ddof=1) / np.sqrt(values.size)",
        "error = sqrt(variance(values) / len(values))",
    ],
)
def test_interval_outside_the_bounds_module_is_detected(source: str) -> None:
    assert [*computed(source)]


def test_intervals_are_computed_only_in_the_module_bounds() -> None:
    modules = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*.py")}
    assert modules.keys() >= HOME
    found = {
        name: [one.partition(": ")[2] for one in told]
        for name, path in modules.items()
        if name not in HOME | DIRECTIONS and (told := [*computed(path.read_text("utf-8"))])
    }
    assert found == NO_INTERVALS
