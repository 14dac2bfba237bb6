"""Each optimiser in the documentation finds the right gain, reproducibly."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.ask_tell import Asking, factory
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Trials
from tests.plugin.searching.test_search import BIAS, GAIN, GOAL, LIMIT, reward

PAGE = Path(__file__).parents[3] / "docs" / "searches.md"
EXAMPLES = {
    name: code
    for code in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    for name in re.findall(r"^# (\w+)\.py", code)
}


def run(candidate: Candidate, seed: int) -> Outcome:
    """Return a reward that depends only on the gain."""
    gain = next((m for m in candidate.mutations if m.operand == GAIN), None)
    return Outcome(reward(gain, seed), passed=True)


def found(name: str, folder: Path) -> tuple[list[float], list[str]]:
    trials = Trials(run, 300)
    make = factory(f"{name}:Search", (folder,))
    search = Asking(f"{name}:Search", make, (LIMIT, GAIN, BIAS), mutations, (ALWAYS,), trials, GOAL, 7)
    repair = next(search.candidates())
    assert [mutation.operand for mutation in repair.mutations] == [GAIN]
    return trials.totals, trials.labels


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_searches_depend_on_the_seed(name: str, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings of the libraries that the examples use
        pytest.importorskip(name.partition("_")[0])
        (tmp_path / f"{name}.py").write_text(EXAMPLES[name])
        assert found(name, tmp_path) == found(name, tmp_path)


def test_the_page_contains_both_examples() -> None:
    assert set(EXAMPLES) == {"cma_search", "optuna_search"}
