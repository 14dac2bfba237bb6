"""Run labelled real nodes in the in-process ROS; print whether each starts and publishes, and which steps are recorded.

Run `python benchmarks/labelled_nodes.py LABELS.json CHECKOUTS`, where CHECKOUTS contains `owner__repository/path` for
each labelled node. Nothing is downloaded, and nothing is written to CHECKOUTS. Each node gets a test in a scratch
folder, which runs with `--tarl-record`. Nodes that need OpenCV run only if `cv2` can be imported.
"""

from __future__ import annotations

import argparse
import ast
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

TEST = """
import sys
sys.path.insert(0, {here!r})
import pytest
from labelled_worlds import WORLDS
from pytest_tarl import Sensor

@pytest.mark.tarl(nodes=[{node!r}], sensors=[Sensor("step", low=0, high=400, bins=8)], drifts={{}}, episodes=2)
def test_node(tarl, monkeypatch, tmp_path):
    WORLDS[{name!r}](tarl, {node!r}, monkeypatch, tmp_path)
    heard = sorted(tarl.ros.subscribed)
    sent = dict(sorted(tarl.ros.published.items()))
    print("TARL-RAN", heard, sent)
    assert sent, "nothing was published"
"""


@dataclass(frozen=True)
class Outcome:
    """The result of a node: its numbers of taint `lists` and `sites`, the `missing` steps, or why it failed."""

    name: str
    api: str
    ran: str = ""
    lists: int = 0
    sites: int = 0
    missing: tuple[str, ...] = ()
    reason: str = ""

    def row(self) -> str:
        """Return a row of the table."""
        if self.reason:
            return f"| {self.name} | {self.api} | no | {self.reason} |"
        lists = f"{self.lists} taint list{'s' * (self.lists != 1)}"
        seen = self.sites - len(self.missing)
        done = f"{seen} of {self.sites} steps on {lists}" if self.sites else "no flows"
        said = f"; not: {', '.join(self.missing)}" if self.missing else ""
        return f"| {self.name} | {self.api} | yes | {self.ran}; {done}{said} |"


def run(label: dict[str, Any], checkouts: Path) -> Outcome:
    """Run one labelled node."""
    from labelled_worlds import WORLDS

    path = checkouts / label["repo"].replace("/", "__") / label["path"]
    outcome = Outcome(path.name, label["dialect"])
    if not path.is_file():
        return Outcome(outcome.name, outcome.api, reason="no such file")
    try:
        ast.parse(path.read_bytes())
    except SyntaxError as error:
        return Outcome(outcome.name, outcome.api, reason=f"Python 2: line {error.lineno}, {error.msg}")
    if path.name not in WORLDS:
        return Outcome(outcome.name, outcome.api, reason="no world was written for this node")
    with tempfile.TemporaryDirectory() as folder:
        return record(outcome, path, Path(folder))


def record(outcome: Outcome, node: Path, folder: Path) -> Outcome:
    """Record a test of the node in a scratch folder, and read the recording."""
    here = str(Path(__file__).parent)
    (folder / "test_it.py").write_text(TEST.format(here=here, node=str(node), name=node.name))
    command = [sys.executable, "-m", "pytest", "-q", "-s", "-p", "no:cacheprovider", "test_it.py"]
    plain = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    ran = next((line[9:] for line in plain.stdout.splitlines() if line.startswith("TARL-RAN")), "")
    if plain.returncode:
        return Outcome(outcome.name, outcome.api, reason=_why(plain.stdout + plain.stderr))
    recorded = subprocess.run(
        [*command, "--tarl-record"], cwd=folder, capture_output=True, text=True, check=False
    )
    found = sorted((folder / ".tarl" / "utility").glob("*.npz"))
    if not found:
        said = _why(recorded.stdout + recorded.stderr)
        if said.startswith("No flow from"):
            return Outcome(outcome.name, outcome.api, _heard(ran))
        return Outcome(outcome.name, outcome.api, reason=said)
    return read(outcome, ran, found[0])


def read(outcome: Outcome, ran: str, path: Path) -> Outcome:
    """Return which of the node's steps are in a recording."""
    from pytest_tarl.learning import fixture as fixtures
    from pytest_tarl.learning.tables import START

    fixture = fixtures.load(path)
    sites: dict[str, str] = {}
    seen: set[str] = set()
    for taint_list, sample in zip(fixture.lists, fixture.sample.lists, strict=True):
        states = sample.visits.state[sample.visits.state != START]
        visited = {int(state - 1) % sample.width for state in states}
        for number, place in enumerate(taint_list.sites):
            sites[place.id] = f"line {place.line} `{' '.join(place.code.split())}`"
            if number in visited:
                seen.add(place.id)
    missing = tuple(text for site, text in sites.items() if site not in seen)
    return Outcome(outcome.name, outcome.api, _heard(ran), len(fixture.lists), len(sites), missing)


def _heard(ran: str) -> str:
    heard, _, sent = ran.strip().replace("'", "").partition("] ")
    return f"receives {heard.strip('[') or 'nothing'}, publishes {sent.strip('{}')}"


def _why(output: str) -> str:
    """Return the sentence below the failed test's heading in pytest's output."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    headline = next((i for i, line in enumerate(lines) if line.strip("_ ") == "test_node"), -2)
    return re.sub(r"/\S*/", "", lines[headline + 1] if lines else "?")[:220].replace("|", "/")


def main() -> None:
    """Print a row for each labelled node."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("labels", type=Path, help="the labels, a JSON list with repo, path and dialect")
    parser.add_argument("checkouts", type=Path, help="folder that contains owner__repository/path")
    parser.add_argument("--only", default="", help="run the nodes whose file name contains this")
    options = parser.parse_args()
    print("| node | API | runs | what it does, which steps were recorded |\n|---|---|---|---|")
    outcomes = []
    for label in json.loads(options.labels.read_text()):
        if options.only in label["path"]:
            outcomes.append(run(label, options.checkouts.resolve()))
            print(outcomes[-1].row(), flush=True)
    whole = sum(not outcome.reason and not outcome.missing for outcome in outcomes)
    print(f"\n{whole} of {len(outcomes)} start, publish and have every step of their taint lists recorded.")


if __name__ == "__main__":
    main()
