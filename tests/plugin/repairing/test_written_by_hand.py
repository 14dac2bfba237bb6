"""Where a repair is written: at the definition of a parameter, and into which files; all other parts are scripted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Edit
from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import delivering
from pytest_tarl.repairing.labels import quantities
from pytest_tarl.repairing.placing import MOST_PLACES, Placing, _importers
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair
from tarl_lint.model import Operand, SiteId, Span


@pytest.fixture
def placing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the placing of a parameter of a node, with files and definitions that the test may set."""
    of: Any = SimpleNamespace(
        root=tmp_path,
        analysis=SimpleNamespace(sources={}),
        goal=Goal((Pair(5, 1.0),), near=9.0, enough=9.0, online=1.0),
        fixture=SimpleNamespace(test="test_it.py::test_x"),
        options=SimpleNamespace(edit="auto"),
    )
    made: Any = Placing(SimpleNamespace(order=of, texts={}))  # type: ignore[arg-type]
    made.name, made.written, made.places, made.computed = "~pid/gain", (), [], ""
    module = "pytest_tarl.repairing.placing"
    monkeypatch.setattr(f"{module}.parameter", lambda *_: made.name)
    monkeypatch.setattr(f"{module}.defined", lambda *_: made.written)
    monkeypatch.setattr(f"{module}.package_files", lambda root, file: {"a.yaml": "gain: 2.0"})
    monkeypatch.setattr(f"{module}.configured", lambda name, texts: iter(made.places))
    monkeypatch.setattr(f"{module}.computed_at", lambda name, texts: made.computed)
    return made


GAIN = Operand(SiteId("node", "run", "x = gain", 0), Span("node.py", 3, 5, 3, 9), "gain", 2.0)
CHANGED = Mutation(GAIN, 3.0)


def place(number: int, value: Any = 2.0) -> Place:
    return Place(f"{number}.yaml", 6, 9, number, "gain", value)


def effective(*which: Place, breaks: tuple[Place, ...] = ()) -> tuple[Any, list[Any]]:
    """Return trials in which only changes at these places alter the reward, and the places tried."""
    tried: list[Any] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (mutation,) = candidate.mutations
        tried.append((mutation.place, seed))
        if mutation.place in breaks:
            raise RepairError("odd")
        return Outcome(2.0 if mutation.place in which else 1.0, passed=True)

    return run, tried


def found(placing: Any, trials: Any) -> Any:
    return placing._found(CHANGED, Candidate((CHANGED,), ALWAYS), trials)


def test_parameter_is_changed_at_its_first_effective_place(placing: Any) -> None:
    one, two, three = (place(number) for number in (1, 2, 3))
    placing.places = [one, two, three]
    trials, tried = effective(two, three, breaks=(one,))
    assert found(placing, trials) == (two,)
    assert tried == [(one, 5), (two, 5)]
    assert placing.mutants.texts == {"a.yaml": "gain: 2.0"}
    assert not placing._why


def test_the_definition_in_the_code_comes_first(placing: Any) -> None:
    placing.written, placing.places = (place(0),), [place(1)]
    trials, tried = effective(place(0), place(1))
    assert found(placing, trials) == (place(0),)
    assert len(tried) == 1
    placing.name = ""
    assert found(placing, effective()[0]) == ()
    assert not placing._why  # a constant of the code needs no explanation


def test_values_of_the_same_kind_are_tried_in_a_few_files(placing: Any) -> None:
    numbers = [place(number) for number in range(1, 9)]
    placing.places = [place(20, value=True), *numbers]
    trials, tried = effective(place(20, value=True))
    assert found(placing, trials) == ()
    assert [one for one, _ in tried] == numbers[:MOST_PLACES]


@pytest.mark.parametrize(
    ("text", "computed", "says"),
    [
        ("tarl.start('n.py', parameters={'gain': 3})", "", "the test itself passes it"),
        ("tarl.start('n.py', argv=['_gain:=3'])", "", "the test itself passes it"),
        ("tarl.launch('a'); x = {'gain': 3}", "", "the test itself passes it"),
        ("tarl.launch('all.launch')", "", "the launch file of the test sets it. Change the parameter there"),
        (
            "tarl.launch('a')",
            "a.launch.py:3 computes it",
            "a.launch.py:3 computes it, where no number alone determines it",
        ),
        ("tarl.start('n.py')", "a.launch.py:3 computes it", "this test sets it, and TARL never edits tests"),
        ("again = 3", "", "this test sets it"),
        (None, "", "this test sets it"),
    ],
)
def test_parameter_note_says_who_sets_it(
    placing: Any, tmp_path: Path, text: str | None, computed: str, says: str
) -> None:
    placing.computed = computed
    if text is not None:
        (tmp_path / "test_it.py").write_text(text)
    assert found(placing, effective()[0]) == ()
    (note,) = placing.notes(Candidate((CHANGED,), ALWAYS))
    assert note.startswith("`gain` is changed at its use. The parameter '~pid/gain' has a default and")
    assert says in note


def test_definitions_are_looked_for_once(placing: Any) -> None:
    placing.places = [place(1)]
    trials, tried = effective(place(1))
    candidate = Candidate((CHANGED,), ALWAYS)
    first = placing._places(CHANGED, candidate, trials)
    assert first == placing._places(CHANGED, candidate, trials) == (place(1),)
    assert len(tried) == 1


def test_file_that_names_constant_and_module_uses_it(placing: Any, tmp_path: Path) -> None:
    files = {
        "a.py": "from gains import KP",
        "b.py": "import gains\nprint(gains.KP)",
        "c.py": "from gains import KI",
        "d.py": "KP = 3",
        "e.txt": "gains KP",
        ".hidden/f.py": "from gains import KP",
        "venv/g.py": "from gains import KP",
        "known.py": "from gains import KP",
        "deep/h.py": "from gains import KP",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    of = Place("gains.py", 5, 8, 1, "Gains.KP[0]", 2.0)
    assert _importers(tmp_path, of, {"known.py"}) == ["a.py", "b.py", "deep/h.py"]
    assert _importers(tmp_path, replace(of, path="gains.yaml"), set()) == []


# What is written


@pytest.mark.parametrize("fails", ["source", "verify", "write", ""])
def test_unwritable_partial_repair_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: str
) -> None:
    def unless(name: str, result: Any) -> Any:
        def run(*_: Any) -> Any:
            if fails == name:
                raise RepairError("odd")
            return result

        return run

    (tmp_path / "n.py").write_text("x = 1\n")
    of: Any = SimpleNamespace(
        root=tmp_path,
        patches=tmp_path / "patches",
        fixture=SimpleNamespace(test="t.py::test_x"),
        drift="mud",
        options=SimpleNamespace(seed=3, alpha=0.1),
        comparison=SimpleNamespace(
            totals={"offline": [4.0], "online": [2.0]}, verdict=SimpleNamespace(loss=2.0)
        ),
    )
    mutants: Any = SimpleNamespace(order=of, source=unless("source", {tmp_path / "n.py": "x = 2\n"}))
    monkeypatch.setattr(delivering, "_verify", unless("verify", None))
    monkeypatch.setattr(delivering.patch, "write_partial", unless("write", tmp_path / "patches" / "one.txt"))
    monkeypatch.setattr(delivering, "_guard", lambda *_: "")
    monkeypatch.setattr(delivering, "_edits", lambda *_: (Edit("n.py", 1, "1", 2.0),))
    monkeypatch.setattr(delivering, "_again", lambda _: "pytest")
    monkeypatch.setattr(delivering, "_recorded", lambda _: ["fixture: x"])
    monkeypatch.setattr(delivering.repair_words, "partial_words", lambda *_: "half of the loss")
    gained = SimpleNamespace
    best: Any = SimpleNamespace(
        candidate=Candidate((), ALWAYS),
        drifted=gained(mean=1.0, low=0.5),
        designed=gained(mean=-0.1, low=-0.2),
    )
    made = delivering.partial(mutants, best)
    if fails:
        assert made is None
        return
    assert made is not None
    assert made.patch == "patches/one.txt"
    assert made.confidence == pytest.approx(0.9)
    assert (made.gain, made.low, made.lost, made.designed, made.designed_low) == (1.0, 0.5, 2.0, -0.1, -0.2)
    lines = made.diff.splitlines()
    assert "+x = 2" in lines
    assert [one for one in lines if one.startswith("-x")] == ["-x = 1"]


@pytest.mark.parametrize("fails", [False, True])
def test_unwritable_patch_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: bool) -> None:
    def write(*_: Any) -> Path:
        if fails:
            raise RepairError("read-only")
        return tmp_path / "patches" / "one.patch"

    written: list[Path] = []
    monkeypatch.setattr(delivering.patch, "write", write)
    monkeypatch.setattr(delivering, "read", lambda path: path)
    monkeypatch.setattr(delivering, "sarif", str)

    def sarif_written(path: Path, data: bytes, *, parents: bool) -> None:
        written.append(path)
        raise OSError  # without the file for editors, the patch is still there

    monkeypatch.setattr(delivering, "write_atomically", sarif_written)
    of: Any = SimpleNamespace(root=tmp_path, patches=tmp_path, fixture=SimpleNamespace(test="t"), drift="mud")
    assert delivering._written(of, "diff") == ("" if fails else "patches/one.patch")
    assert written == ([] if fails else [tmp_path / "patches" / "one.sarif"])


def test_operand_of_unknown_source_is_a_quantity() -> None:
    analysis: Any = SimpleNamespace(sources={"node.py": "x = 1\n"})
    elsewhere = Operand(SiteId("n", "f", "x", 0), Span("other.py", 1, 5, 1, 6), "1", 1)
    lost = Operand(SiteId("n", "f", "x", 0), Span("node.py", 1, 9, 1, 12), "abc", 1)
    assert quantities(analysis, [elsewhere, lost]) == [elsewhere, lost]
