"""Every package of pytest_tarl has an import contract; the contract of `ros` names every module."""

from __future__ import annotations

import pkgutil
import re
import sys
from pathlib import Path
from typing import Any

import pytest

import pytest_tarl

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SETTINGS = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
CONTRACTS: list[dict[str, Any]] = SETTINGS["tool"]["importlinter"]["contracts"]
FOUND = {one.name: one.ispkg for one in pkgutil.walk_packages(pytest_tarl.__path__, "pytest_tarl.")}
ROS = "pytest_tarl.ros"


def test_every_package_has_a_contract() -> None:
    packages = {name for name, ispkg in FOUND.items() if ispkg and name.count(".") == 1}
    covered = {name for contract in CONTRACTS for name in contract.get("containers", ())}
    assert {"pytest_tarl", *packages} - covered == set()


@pytest.mark.parametrize(
    "contract", [one for one in CONTRACTS if "containers" in one], ids=lambda one: one["name"]
)
def test_a_contract_that_is_not_exhaustive_has_a_test(contract: dict[str, Any]) -> None:
    assert contract.get("exhaustive") or contract["containers"] in (["tarl_lint"], [ROS])


def test_the_contract_of_ros_names_its_modules_once() -> None:
    (contract,) = (one for one in CONTRACTS if one.get("containers") == [ROS])
    named = [f"{ROS}.{name.strip()}" for layer in contract["layers"] for name in re.split("[|:]", layer)]
    parents = {name.rpartition(".")[0] for name in FOUND}
    assert sorted(named) == sorted(
        name for name in FOUND if name.startswith(f"{ROS}.") and name not in parents
    )
