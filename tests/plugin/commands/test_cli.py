"""`tarl show` and `tarl diff`, on recordings in files."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.learning.fixture import Fixture, save
from tests.plugin.learning.test_fixture import example


def saved(fixture: Fixture, path: Path) -> str:
    save(fixture, path)
    return str(path)


def test_show_prints_test_reward_sensors_and_sites(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fixture = example()
    assert main(["show", saved(fixture, tmp_path / "a.npz")]) == 0
    told = capsys.readouterr().out
    assert told.startswith("test_node.py::test_it, seed 3\n  episodes   6,")
    assert "x: /in0 data, 0 to 1 in 4 bins" in told
    assert "terrain: observed" in told
    assert all(f"{site.path}:{site.line}" in told for one in fixture.lists for site in one.sites)
    assert "/in0 → /out:" in told


def test_show_prints_the_size_of_each_list(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(example(), tmp_path / "a.npz")
    assert main(["show", path]) == 0
    told = capsys.readouterr().out
    whole, lists = (float(part.split()[-1]) for part in re.findall(r"size .*", told)[0].split(" kB")[:2])
    own = [float(size) for size in re.findall(r"mean \|f\| .*, ([\d.]+) kB", told)]
    assert whole == pytest.approx(Path(path).stat().st_size / 1000, abs=0.06)
    assert 0 < lists < whole
    assert sum(own) == pytest.approx(lists, abs=0.06 * len(own))


def test_a_recording_does_not_differ_from_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(example(), tmp_path / "a.npz")
    assert main(["diff", path, path, "--fail-if-worse"]) == 0
    told = capsys.readouterr().out
    assert "0 gone, 0 new" in told
    assert not any(line.startswith(("  gone", "  new", "  moved")) for line in told.splitlines())


def test_fail_if_worse_fails_on_a_significant_loss(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good = example()
    bad = replace(good, sample=replace(good.sample, total=good.sample.total - 50.0))
    paths = [saved(good, tmp_path / "a.npz"), saved(bad, tmp_path / "b.npz")]
    assert main(["diff", *paths]) == 0
    assert main(["diff", *paths, "--fail-if-worse"]) == 1
    assert main(["diff", *paths, "--fail-if-worse", "--max-loss=60"]) == 0
    assert main(["diff", *paths, "--fail-if-worse", "--alpha=0.0001"]) == 0
    assert main(["diff", *reversed(paths), "--fail-if-worse"]) == 0
    assert "reward" in capsys.readouterr().out


def test_diff_lists_moved_removed_and_new_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = example()
    moved, kept, gone = before.lists[0].sites
    sites = (replace(moved, line=moved.line + 40), kept, replace(gone, id="another", code="y = 1", line=77))
    after = replace(before, lists=(replace(before.lists[0], sites=sites), *before.lists[1:]))
    main(["diff", saved(before, tmp_path / "a.npz"), saved(after, tmp_path / "b.npz")])
    told = capsys.readouterr().out
    assert f"`{moved.code}` from line {moved.line} to {moved.line + 40}: its slice is kept" in told
    assert (
        f"gone       `{gone.code}` of node.py:{gone.line}: its slice is lost; verdict and region remain valid"
        in told
    )
    assert "new        `y = 1` at node.py:77" in told
    paths = [str(tmp_path / "a.npz"), str(tmp_path / "b.npz")]
    assert main(["diff", *paths, "--fail-if-worse"]) == 0
    assert main(["diff", *paths, "--fail-if-changed"]) == 1
    assert main(["diff", paths[0], paths[0], "--fail-if-changed"]) == 0


def test_an_unreadable_recording_is_reported_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.npz").write_text("no fixture")
    assert main(["show", str(tmp_path / "a.npz")]) == 2
    assert main(["show", str(tmp_path / "b.npz")]) == 2
    told = capsys.readouterr().err
    assert "a.npz is damaged" in told
    assert "no such recording" in told


def test_long_statement_lists_are_shown_only_on_request(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    fixture = example()
    path = saved(fixture, tmp_path / "a.npz")
    monkeypatch.setattr("pytest_tarl.commands.show.FEW", 0)
    assert main(["show", path]) == 0
    short = capsys.readouterr().out
    assert main(["show", path, "--sites"]) == 0
    whole = capsys.readouterr().out
    statements = sum(len(one.sites) for one in fixture.lists)
    assert f"tarl show --sites lists the {statements} statements" in short
    assert "/in0 → /out:" in short
    assert len(whole.splitlines()) == len(short.splitlines()) + statements - 1


def test_long_differences_are_shortened_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = example()
    sites = {site.id for one in before.lists for site in one.sites}
    lists = tuple(
        replace(one, sites=tuple(replace(site, id=f"other {site.id}") for site in one.sites))
        for one in before.lists
    )
    after = replace(before, lists=lists)
    monkeypatch.setattr("pytest_tarl.commands.diff.MOST", 1)
    assert main(["diff", saved(before, tmp_path / "a.npz"), saved(after, tmp_path / "b.npz")]) == 0
    told = capsys.readouterr().out
    assert told.count(f"… and {len(sites) - 1} more") == 2


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert left.value.code == 0
    assert re.fullmatch(r"tarl \d+\.\d+\S*", capsys.readouterr().out.strip())
