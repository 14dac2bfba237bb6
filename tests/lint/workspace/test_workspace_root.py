"""The folder that is the workspace around a path."""

from pathlib import Path

import pytest

from tarl_lint.workspace.folders import workspace_root


@pytest.mark.parametrize("package", ["src/arm", "src/repository/arm"])
@pytest.mark.parametrize("built", [True, False])
def test_a_path_beside_the_sources_is_in_the_workspace(tmp_path: Path, package: str, *, built: bool) -> None:
    (tmp_path / package).mkdir(parents=True)
    (tmp_path / package / "package.xml").touch()
    (tmp_path / "tests").mkdir()
    if built:
        (tmp_path / "install").mkdir()
    assert workspace_root(tmp_path) == workspace_root(tmp_path / "tests" / "test_arm.py") == tmp_path
    assert (
        workspace_root(tmp_path / package)
        == (tmp_path / package).parents[0 if not built else package.count("/") - 1]
    )


def test_a_folder_of_other_sources_is_not_a_workspace(tmp_path: Path) -> None:
    (tmp_path / "src/arm").mkdir(parents=True)
    assert workspace_root(tmp_path) is None
