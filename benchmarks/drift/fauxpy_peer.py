"""FauxPy as a localiser: rankings by spectra (SBFL) and by mutants (MBFL) from four designed and four drifted episodes.

A site gets the score of the best of its lines. Sites with equal scores all get the mean of their ranks, as is usual.
FauxPy proposes no repair. FauxPy needs an environment of its own, since it pins plugins of pytest.
"""

from __future__ import annotations

import csv
import os
import re
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stage import Stage

from pytest_tarl.seeds import episode_seeds

FAUXPY = ("FauxPy SBFL", "FauxPy MBFL")
EPISODES = 4  # number of episodes of each world
PATIENCE = 3600  # time limit (s)
CONFTEST = """\
from pytest_tarl.item_episode import EPISODE, Episode, designated
from pytest_tarl.rollout import EpisodePlan

CASES = [(seed, drifted) for drifted in (False, True) for seed in SEEDS]


def pytest_generate_tests(metafunc):
    if "tarl_drift" in metafunc.fixturenames:
        metafunc.parametrize("tarl_drift", CASES, ids=[f"case{at}" for at in range(len(CASES))], indirect=True)


def pytest_runtest_setup(item):
    seed, drifted = item.callspec.params["tarl_drift"]
    marked = designated(item)
    drift = next(iter(marked.drifts)) if drifted else None
    item.stash[EPISODE] = Episode(EpisodePlan(seed, drift), marked)
"""


def localised(stage: Stage, seed: int, method: str, python: str | None) -> dict[str, Any]:
    """Rank the lines of a task with FauxPy; return, for each metric, the rank of the right sites or the failure."""
    found: dict[str, Any] = {"ranks": {}, "accepted": False, "failed": "", "episodes": {}}
    if python is None:
        return found | {"failed": "not run: name the Python of its environment, --fauxpy PYTHON"}
    (test,) = stage.folder.glob("test_*.py")
    seeds = episode_seeds(seed, "fauxpy", EPISODES)
    (stage.folder / "conftest.py").write_text(CONFTEST.replace("SEEDS", repr([*seeds])))
    family = method.split()[1].lower()
    excluded = f"[{test.name},conftest.py]"
    command = [
        python,
        "-m",
        "pytest",
        "-q",
        test.name,
        "--src",
        ".",
        "--exclude",
        excluded,
        "--family",
        family,
    ]
    path = os.pathsep.join(
        [str(Path(python).parent), os.environ.get("PATH", "")]
    )  # FauxPy runs mutants by the command `python`, so this Python must come first in PATH
    surroundings = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | {"PATH": path}
    try:
        done = subprocess.run(
            command,
            cwd=stage.folder,
            env=surroundings,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return found | {"failed": f"did not end within {PATIENCE} s"}
    mutants = re.search(r"Number of generated mutants: (\d+)", done.stdout)
    runs = 2 * EPISODES * (1 + (int(mutants[1]) if mutants else 0))
    scores = {
        file.stem.removeprefix("Scores_"): file for file in stage.folder.parent.glob("FauxPy*/Scores_*.csv")
    }
    if not scores:
        said = (done.stdout + done.stderr).strip().splitlines()
        return found | {"failed": said[-1] if said else f"ended with status {done.returncode}"}
    ranks = {name: _rank(stage, _by_line(file)) for name, file in sorted(scores.items())}
    return found | {"ranks": ranks, "episodes": {"search": runs}}


def _by_line(file: Path) -> dict[tuple[str, int], float]:
    """Return scores by file name and line."""
    with file.open(encoding="utf-8") as text:
        rows = [(row["Entity"].rpartition("::"), float(row["Score"])) for row in csv.DictReader(text)]
    return {(Path(where).name, int(line)): score for (where, _, line), score in rows}


def _rank(stage: Stage, scores: Mapping[tuple[str, int], float]) -> float | None:
    """Return the rank of the best right set; the rank of a set is that of its last site."""
    by_site: dict[str, float] = {}
    for step in stage.analysis.sites:
        lines = range(step.span.line, step.span.end_line + 1)
        told = [scores[at] for line in lines if (at := (Path(step.span.path).name, line)) in scores]
        if told:
            by_site[str(step.site)] = max(told)
    sets = [right for right in stage.answer.get("right", ()) if all(site in by_site for site in right)]
    return min((_middle(right, by_site) for right in sets), default=None)


def _middle(right: Sequence[str], by_site: Mapping[str, float]) -> float:
    least = min(by_site[site] for site in right)
    others = [score for site, score in by_site.items() if site not in right]
    return 1 + sum(score > least for score in others) + sum(score == least for score in others) / 2
