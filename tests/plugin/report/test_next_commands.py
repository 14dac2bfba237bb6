"""Commands that a report prints: they repeat the comparison, or are the next step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from pytest_tarl.model import Comparison, SearchTrace, Verdict
from pytest_tarl.report import next_commands

Varied = Callable[..., Comparison]
TEST = "tests/test_traveller.py::test_delivers"


def searched(*methods: str) -> tuple[SearchTrace, ...]:
    return tuple(SearchTrace(method, (1.0,)) for method in methods)


def test_command_names_non_default_flags(varied: Varied) -> None:
    one = varied(seed=0, drift=None)
    assert next_commands.command(one) == f"pytest {TEST} --tarl-online"
    every = varied(seed=3, flags=("--tarl-alpha", "0.1"), target="a file.py::test")
    assert next_commands.command(every, "--last") == (
        "pytest 'a file.py::test' --tarl-online --tarl-drift mud --tarl-seed 3 --tarl-alpha 0.1 --last"
    )


@pytest.mark.parametrize(
    ("methods", "expected"),
    [
        (("sweep",), ""),
        (("sweep", "structure"), ""),
        (("ranking", "sweep"), " --tarl-localize full"),
        (("epsilon-greedy",), " --tarl-search epsilon-greedy"),
        (("epsilon-greedy", "sweep"), " --tarl-search epsilon-greedy --tarl-search sweep"),
        (("ranking", "bayes", "structure"), " --tarl-search bayes --tarl-localize full"),
        ((), ""),
    ],
)
def test_a_repair_is_repeated_with_its_searches(
    varied: Varied, methods: tuple[str, ...], expected: str
) -> None:
    one = varied(seed=0, searches=searched(*methods))
    assert (
        next_commands.repeat(one) == f"pytest {TEST} --tarl-online --tarl-drift mud --tarl-repair{expected}"
    )


def test_command_omits_fruitless_searches(varied: Varied) -> None:
    one = varied(seed=0, repair=None, searches=searched("epsilon-greedy"))
    assert next_commands.repeat(one) == f"pytest {TEST} --tarl-online --tarl-drift mud"


def test_accepted_patch_is_applied_next(varied: Varied, shuttle: Comparison) -> None:
    repair = shuttle.repair
    assert repair is not None
    apply = "tarl apply .tarl/patches/test-delivers-mud-1a2b3c4d.patch"
    assert [*next_commands.next_steps(shuttle)] == [apply]
    assert [*next_commands.next_steps(varied(permanent=True))] == [
        apply,
        f"pytest {TEST} --tarl-record --tarl-drift mud",
    ]
    assert next_commands.recording(varied(drift=None, target="t.py")) == "pytest t.py --tarl-record"
    for nothing in (replace(repair, accepted=False), replace(repair, patch="")):
        assert [*next_commands.next_steps(varied(repair=nothing))] == []


@pytest.mark.parametrize("folder", ["src/robot/", "../robot/"])
def test_patch_path_is_relative_to_the_start_folder(varied: Varied, folder: str) -> None:
    one = varied(test=TEST, target=f"{folder}{TEST}")
    assert [*next_commands.next_steps(one)] == [
        f"tarl apply {folder}.tarl/patches/test-delivers-mud-1a2b3c4d.patch"
    ]


def test_degraded_test_is_repaired_next(varied: Varied, unchanged: Comparison) -> None:
    one = varied(seed=0, repair=None)
    assert [*next_commands.next_steps(one)] == [f"pytest {TEST} --tarl-online --tarl-drift mud --tarl-repair"]
    for flag in ("--tarl-log", "--tarl-bag"):
        assert [*next_commands.next_steps(replace(one, flags=(flag, "file")))] == []
    drifted = Verdict("drifted", 0.001, 0.5, 0.0, 0.4, 0.5)
    assert [*next_commands.next_steps(replace(one, verdict=drifted))] == []
    assert [*next_commands.next_steps(unchanged)] == []


def test_lost_taint_lists_are_recorded_again_first(varied: Varied) -> None:
    assert [*next_commands.next_steps(varied(lists=()))] == [f"pytest {TEST} --tarl-record"]
