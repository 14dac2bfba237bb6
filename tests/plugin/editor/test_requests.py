"""The language server without a client: what it publishes after a change, and its answers from the last result."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("pygls")

from lsprotocol import types
from pygls.workspace import Workspace

from pytest_tarl.editor import fixes, recorded
from pytest_tarl.editor import server as server_module
from pytest_tarl.editor.positions import Places
from pytest_tarl.editor.server import Server, server
from pytest_tarl.errors import TarlError
from tarl_lint.editing import Superseded
from tarl_lint.errors import LintError
from tarl_lint.run.runner import Result
from tests.plugin.editor.graphs import TEXT, finding, flow, span, step

TEXTS = {"pilot.py": TEXT, "map.py": "a\nb\n"}
FOUND = Result(findings=(finding(of=flow()),), texts=TEXTS)
NOTHING = Result(texts=TEXTS)
SPEED = "pilot:<module>:speed = 2 * goal"


class Linted:
    """Stand-in for an analysed workspace: the given results in turn, and what it was asked."""

    def __init__(self, *results: Any) -> None:
        self.results = list(results)
        self.buffers: list[dict[Path, str]] = []
        self.accepted: list[str] = []
        self.during: Callable[[Callable[[], bool], Any], None] = lambda _current, _early: None

    def lint(self, buffers: dict[Path, str], current: Callable[[], bool], early: Any) -> Result:
        self.buffers.append(buffers)
        self.during(current, early)
        found = self.results.pop(0)
        if isinstance(found, BaseException):
            raise found
        result: Result = found
        return result

    def accept(self, fingerprint: str, _: Result) -> Path:
        if fingerprint == "bad":
            raise LintError("the baseline cannot be written")
        self.accepted.append(fingerprint)
        return Path("/somewhere/tarl-flows.json")


class Session:
    """A server on a folder, without a client, and the notifications that it sends."""

    def __init__(self, root: Path, apply: Callable[[Path], Iterable[str]] = lambda _: []) -> None:
        self.root = root
        self.published: list[tuple[str, list[str]]] = []
        self.said: list[tuple[types.MessageType, str]] = []
        self.refreshed: list[str] = []
        self.server = made = server(apply)
        protocol: Any = made.protocol
        protocol._workspace = Workspace(root.as_uri())
        protocol.client_capabilities = types.ClientCapabilities()
        sent: Any = made
        sent.text_document_publish_diagnostics = lambda shown: self.published.append(
            (Path(shown.uri).name, [str(one.code) for one in shown.diagnostics])
        )
        sent.window_show_message = lambda shown: self.said.append((shown.type, shown.message))
        sent.workspace_code_lens_refresh = lambda *_: self.refreshed.append("lenses")
        sent.workspace_inlay_hint_refresh = lambda *_: self.refreshed.append("hints")
        made.root = root

    def lint(self, *results: Any) -> Linted:
        """Lint once for each result."""
        linted: Any = Linted(*results)
        self.server.linted = linted

        async def run() -> None:
            for _ in results:
                await self.server.lint()

        asyncio.run(run())
        found: Linted = linted
        return found

    def uri(self, name: str) -> str:
        return (self.root / name).as_uri()

    def asked(self, feature: str, params: Any) -> Any:
        return self.server.protocol.fm.features[feature](params)

    def commanded(self, command: str, argument: str) -> None:
        asyncio.run(self.server.protocol.fm.commands[command](argument))


@pytest.fixture
def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Session:
    monkeypatch.chdir(tmp_path)
    return Session(tmp_path)


def test_only_changed_diagnostics_are_published(session: Session) -> None:
    hazard = finding("TARL201", span=span(1, path="map.py"))
    both = Result(findings=(finding(of=flow()), hazard), texts=TEXTS)
    session.lint(FOUND, FOUND, both, NOTHING, NOTHING)
    assert session.published == [
        ("pilot.py", ["TARL101"]),
        ("map.py", ["TARL201"]),
        ("map.py", []),
        ("pilot.py", []),
    ]
    assert session.server.result is NOTHING
    assert session.server.shown == {}
    assert session.server.places is session.server.shown_in


def test_without_a_workspace_nothing_is_linted(session: Session) -> None:
    asyncio.run(session.server.lint())
    assert session.server.result is None
    assert session.published == []


def test_a_superseded_run_changes_nothing(session: Session) -> None:
    session.lint(FOUND, Superseded())
    assert session.server.result is FOUND
    assert [name for name, _ in session.published] == ["pilot.py"]


def test_a_problem_is_shown_once_until_linting_succeeds_again(session: Session) -> None:
    first, other = LintError("bad settings"), LintError("bad baseline")
    session.lint(first, first, other, NOTHING, other)
    assert session.said == [
        (types.MessageType.Warning, f"tarl: {text}")
        for text in ("bad settings", "bad baseline", "bad baseline")
    ]


def test_a_further_change_makes_the_current_run_obsolete(session: Session) -> None:
    seen: list[bool] = []
    linted: Any = Linted(NOTHING)

    def during(current: Callable[[], bool], _: Any) -> None:
        seen.append(current())
        session.server._changes += 1
        seen.append(current())

    linted.during = during
    session.server.linted = linted
    asyncio.run(session.server.lint())
    assert seen == [True, False]


@pytest.mark.parametrize(("changes", "names"), [(0, ["pilot.py", "map.py"]), (1, ["map.py", "pilot.py"])])
def test_final_files_are_published_early_unless_edited(
    session: Session, changes: int, names: list[str]
) -> None:
    hazard = finding("TARL201", span=span(1, path="map.py"))
    both = Result(findings=(finding(of=flow()), hazard), texts=TEXTS)
    linted: Any = Linted(both)

    def during(_: Any, early: Any) -> None:
        session.server._changes += changes
        early(both, frozenset({"pilot.py"}))

    linted.during = during
    session.server.linted = linted
    asyncio.run(session.server.lint())
    assert [name for name, _ in session.published] == names


def test_early_results_clear_old_diagnostics(session: Session) -> None:
    session.lint(FOUND)
    session.server._publish_some(NOTHING, frozenset({"map.py"}))
    assert session.published == [("pilot.py", ["TARL101"])]
    session.server._publish_some(NOTHING, frozenset({"pilot.py"}))
    assert session.published[1:] == [("pilot.py", [])]


@pytest.mark.parametrize(
    ("lens", "hint", "refreshed"),
    [
        (None, None, []),
        (True, None, ["lenses"]),
        (None, True, ["hints"]),
        (True, True, ["lenses", "hints"]),
        (False, False, []),
    ],
)
def test_lenses_and_hints_are_refreshed_if_the_client_can(
    session: Session, lens: Any, hint: Any, refreshed: list[str]
) -> None:
    session.lint(NOTHING)
    assert session.refreshed == []
    session.server.protocol.client_capabilities = types.ClientCapabilities(
        workspace=types.WorkspaceClientCapabilities(
            code_lens=None if lens is None else types.CodeLensWorkspaceClientCapabilities(lens),
            inlay_hint=None if hint is None else types.InlayHintWorkspaceClientCapabilities(hint),
        )
    )
    session.lint(NOTHING)
    assert session.refreshed == refreshed


def opened(session: Session, uri: str, text: str = "x") -> None:
    session.server.workspace.put_text_document(types.TextDocumentItem(uri, "python", 1, text))


def test_open_python_files_are_linted_as_typed(session: Session, tmp_path: Path) -> None:
    opened(session, session.uri("a.py"), "a = 1\n")
    opened(session, session.uri("notes.md"))
    opened(session, (tmp_path.parent / "other.py").as_uri())
    opened(session, "untitled:Untitled-1.py")
    linted = session.lint(NOTHING)
    assert linted.buffers == [{tmp_path / "a.py": "a = 1\n"}]


def test_files_outside_the_root_are_ignored(session: Session, tmp_path: Path) -> None:
    assert session.server.path(session.uri("in/a.py")) == tmp_path / "in" / "a.py"
    assert session.server.shown_path(session.uri("in/a.py")) == "in/a.py"
    for uri in ((tmp_path.parent / "b.py").as_uri(), "untitled:Untitled-1"):
        assert session.server.path(uri) is None
        assert session.server.shown_path(uri) is None


def test_several_changes_in_a_row_cause_one_run(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "PAUSE", 0.0)
    linted: Any = Linted(NOTHING, NOTHING)
    session.server.linted = linted

    async def run() -> None:
        for _ in range(3):
            session.server.changed()
        assert session.server._waiting is not None
        await session.server._waiting
        assert session.server._changes == 3
        session.asked("textDocument/didChange", None)
        await session.server._waiting

    asyncio.run(run())
    assert len(linted.buffers) == 2


def test_linting_starts_after_a_pause(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    linted: Any = Linted(NOTHING)
    session.server.linted = linted
    waits: list[tuple[float, int]] = []

    async def sleep(seconds: float) -> None:
        waits.append((seconds, len(linted.buffers)))

    monkeypatch.setattr(server_module.asyncio, "sleep", sleep)

    async def run() -> None:
        session.server.changed()
        assert session.server._waiting is not None
        await session.server._waiting

    asyncio.run(run())
    assert (waits, len(linted.buffers)) == ([(server_module.PAUSE, 0)], 1)


@pytest.mark.parametrize("event", server_module.CHANGES)
def test_each_change_of_a_file_is_noticed(
    session: Session, event: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    noticed: list[int] = []
    monkeypatch.setattr(session.server, "changed", lambda: noticed.append(1))
    session.asked(event, None)
    assert noticed == [1]


def test_root_is_the_first_workspace_folder_or_a_fallback(session: Session, tmp_path: Path) -> None:
    def root(folders: Sequence[str], path: str | None) -> Path:
        known = {name: types.WorkspaceFolder(name, name) for name in folders}
        ls: Any = SimpleNamespace(workspace=SimpleNamespace(folders=known, root_path=path))
        return server_module._root(ls)

    first, second = (tmp_path / name for name in ("a", "b"))
    assert root([first.as_uri(), second.as_uri()], str(second)) == first.resolve()
    assert root(["untitled:x", second.as_uri()], None) == second.resolve()
    assert root([], str(second)) == second.resolve()
    assert root([], None) == Path.cwd()


def test_server_lints_its_root_when_initialized(
    session: Session, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "inner").mkdir()
    monkeypatch.setattr(server_module, "_root", lambda _: tmp_path / "inner")
    monkeypatch.setattr(
        server_module, "Workspace", lambda paths: Linted(NOTHING) if paths == [Path.cwd()] else None
    )
    asyncio.run(session.asked("initialized", types.InitializedParams()))
    assert session.server.root == tmp_path / "inner" == Path.cwd()
    assert session.server.result is NOTHING


# answers from the last result


def figures(rank: int | None = 1) -> tuple[recorded.Figures, ...]:
    return (recorded.Figures("test_a", "mud", 9.0, 2.5, rank),)


@pytest.fixture
def answering(session: Session) -> Session:
    session.lint(FOUND)
    session.server.kept = recorded.Recorded({SPEED: figures()}, {"pilot.py": (Path("/p/a.patch"),)})
    return session


def test_code_lens_request_returns_the_lenses_of_its_file(answering: Session) -> None:
    def titles(name: str) -> list[str]:
        asked = types.CodeLensParams(types.TextDocumentIdentifier(answering.uri(name)))
        return [one.command.title for one in answering.asked("textDocument/codeLens", asked)]

    assert titles("pilot.py") == ["data of /goal"]
    assert titles("map.py") == titles("../outside.py") == []
    answering.server.result = None
    assert titles("pilot.py") == []


def hover(session: Session, line: int, name: str = "pilot.py") -> types.Hover | None:
    where = types.TextDocumentIdentifier(session.uri(name))
    found: types.Hover | None = session.asked(
        "textDocument/hover", types.HoverParams(where, types.Position(line, 3))
    )
    return found


def test_statement_with_figures_has_a_hover(answering: Session) -> None:
    long = step(2, "speed = 2 * goal")
    longer = type(long)(long.site, span(2, 1, 3, end_line=3), long.code, long.role, long.dependence)
    answering.server.result = Result(findings=(finding(of=flow(steps=(longer,))),), texts=TEXTS)
    assert [hover(answering, line) is not None for line in range(4)] == [False, True, True, False]
    found = hover(answering, 1)
    assert found is not None
    assert isinstance(found.contents, types.MarkupContent)
    assert found.contents.kind == types.MarkupKind.Markdown
    assert "| `test_a` | mud | 9 | 2.5 | -6.5 | 1 |" in found.contents.value
    assert found.range == types.Range(types.Position(1, 0), types.Position(2, 2))


def test_hover_needs_figures_and_a_file(answering: Session) -> None:
    assert hover(answering, 1, "../outside.py") is None
    assert hover(answering, 1, "map.py") is None
    answering.server.kept = recorded.Recorded({SPEED: ()})
    assert hover(answering, 1) is None
    answering.server.result = None
    assert hover(answering, 1) is None


def hints(session: Session, first: int, last: int, name: str = "pilot.py") -> list[types.InlayHint]:
    where = types.Range(types.Position(first, 0), types.Position(last, 0))
    asked = types.InlayHintParams(types.TextDocumentIdentifier(session.uri(name)), where)
    found: list[types.InlayHint] = session.asked("textDocument/inlayHint", asked)
    return found


@pytest.mark.parametrize(
    ("first", "last", "count"), [(0, 9, 1), (1, 1, 1), (0, 1, 1), (1, 2, 1), (0, 0, 0), (2, 9, 0)]
)
def test_ranked_statement_has_a_hint_at_its_end(
    answering: Session, first: int, last: int, count: int
) -> None:
    found = hints(answering, first, last)
    assert len(found) == count
    for one in found:
        assert (one.label, one.position) == ("  #1 mud -6.5", types.Position(1, 16))
        assert one.padding_left is True


def test_hints_are_in_the_order_of_the_file(answering: Session) -> None:
    later, first = step(4, "z"), step(2, "y")
    answering.server.result = Result(findings=(finding(of=flow(steps=(later, first))),), texts=TEXTS)
    answering.server.kept = recorded.Recorded({str(one.site): figures() for one in (later, first)})
    assert [one.position.line for one in hints(answering, 0, 9)] == [1, 3]


def test_hints_need_a_rank_and_a_file(answering: Session) -> None:
    assert hints(answering, 0, 9, "../outside.py") == []
    answering.server.kept = recorded.Recorded({SPEED: figures(None)})
    assert hints(answering, 0, 9) == []
    answering.server.kept = recorded.Recorded({SPEED: figures()})
    answering.server.result = None
    assert hints(answering, 0, 9) == []


def titles(session: Session, first: int, last: int, name: str = "pilot.py") -> list[str]:
    where = types.Range(types.Position(first, 0), types.Position(last, 0))
    asked = types.CodeActionParams(
        types.TextDocumentIdentifier(session.uri(name)), where, types.CodeActionContext([])
    )
    return [one.title for one in session.asked("textDocument/codeAction", asked)]


@pytest.mark.parametrize(
    ("first", "last", "touches"),
    [(3, 3, True), (0, 3, True), (3, 9, True), (0, 9, True), (0, 2, False), (4, 9, False)],
)
def test_code_actions_belong_to_the_chosen_lines(
    answering: Session, first: int, last: int, touches: bool
) -> None:
    quick = ["Ignore TARL101 on this line", "Accept this TARL101 into the baseline"] if touches else []
    assert titles(answering, first, last) == [*quick, "Apply the repair a.patch"]


def test_files_outside_the_root_have_no_code_actions(answering: Session) -> None:
    assert titles(answering, 0, 9, "map.py") == []
    assert titles(answering, 0, 9, "../outside.py") == []


def test_before_the_first_result_there_are_no_actions(session: Session) -> None:
    assert titles(session, 0, 9) == []


def test_actions_use_the_text_of_the_published_diagnostics(answering: Session) -> None:
    answering.server.places = Places(answering.root, {})
    where = types.Range(types.Position(3, 0), types.Position(3, 0))
    asked = types.CodeActionParams(
        types.TextDocumentIdentifier(answering.uri("pilot.py")), where, types.CodeActionContext([])
    )
    ignore = answering.asked("textDocument/codeAction", asked)[0]
    (change,) = ignore.edit.changes[answering.uri("pilot.py")]
    assert change.range.start == types.Position(3, len("    out.publish(speed)"))


# commands


def test_accepting_a_finding_names_the_file_and_lints_again(session: Session) -> None:
    session.lint(FOUND)
    linted: Any = Linted(NOTHING)
    session.server.linted = linted
    session.commanded(fixes.ACCEPT, "f1")
    assert linted.accepted == ["f1"]
    assert session.said == [
        (types.MessageType.Warning, "tarl: accepted the finding in tarl-flows.json: commit this file.")
    ]
    assert session.server.result is NOTHING


def test_unacceptable_finding_is_reported_without_a_run(session: Session) -> None:
    session.lint(FOUND)
    linted: Any = Linted()
    session.server.linted = linted
    session.commanded(fixes.ACCEPT, "bad")
    assert [text for _, text in session.said] == ["tarl: the baseline cannot be written"]
    assert linted.buffers == []


@pytest.mark.parametrize(("linted", "result"), [(Linted(), None), (None, FOUND)])
def test_nothing_is_accepted_before_the_first_result(session: Session, linted: Any, result: Any) -> None:
    session.server.linted, session.server.result = linted, result
    session.commanded(fixes.ACCEPT, "f1")
    assert session.said == []


def applying(root: Path, apply: Callable[[Path], Iterable[str]]) -> tuple[Session, Any]:
    session, linted = Session(root, apply), Linted(NOTHING)
    found: Any = linted
    session.server.linted = found
    session.commanded(fixes.APPLY, "/p/a.patch")
    return session, linted


def test_applying_a_repair_shows_its_lines_and_lints_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, linted = applying(tmp_path, lambda path: [f"applied {path.name}", "run the tests"])
    assert session.said == [(types.MessageType.Info, "applied a.patch\nrun the tests")]
    assert len(linted.buffers) == 1


def test_a_repair_that_does_not_fit_is_reported(tmp_path: Path) -> None:
    def misfit(path: Path) -> Iterable[str]:
        raise TarlError(f"{path.name} does not fit")

    session, linted = applying(tmp_path, misfit)
    assert session.said == [(types.MessageType.Warning, "tarl: a.patch does not fit")]
    assert len(linted.buffers) == 1


def test_without_the_plugin_no_repair_is_applied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "missing_extra", lambda what: f"{what} needs more")
    session, linted = applying(tmp_path, lambda _: pytest.fail("applied"))
    assert session.said == [(types.MessageType.Warning, "tarl: Applying a repair needs more")]
    assert linted.buffers == []


def test_the_server_serves_standard_input_and_output(monkeypatch: pytest.MonkeyPatch) -> None:
    served: list[Server] = []
    monkeypatch.setattr(Server, "start_io", lambda made: served.append(made))
    assert server_module.main(lambda _: []) == 0
    assert len(served) == 1
