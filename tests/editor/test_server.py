"""`tarl lsp`, driven as an editor drives it. It runs by itself, with asyncio on: `make test-editor`."""

from __future__ import annotations

import ast
import asyncio
import json
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest_lsp
from lsprotocol import types as lsp
from pytest_lsp import ClientServerConfig, LanguageClient, client_capabilities

NODE = """\
import rospy
from std_msgs.msg import Float64

stopped = False
out = rospy.Publisher("/wheels", Float64, queue_size=1)


def on_stop(message):
    global stopped
    stopped = message.data > 0


def on_goal(message):
    speed = 2 * message.data
    if not stopped:
        out.publish(speed)


rospy.init_node("pilot")
rospy.Subscriber("/stop", Float64, on_stop)
rospy.Subscriber("/goal", Float64, on_goal)
rospy.spin()
"""
SPEED = NODE.splitlines().index("    speed = 2 * message.data")
PUBLISH = NODE.splitlines().index("        out.publish(speed)")
RESULT = {
    "format": 1,
    "test": "test_pilot.py::test_arrives",
    "drift": "mud",
    "sites": [
        {
            "site": "pilot:on_goal:speed = 2 * message.data",
            "path": "pilot.py",
            "line": 3,
            "offline": 9.0,
            "online": 2.5,
        }
    ],
    "culprits": [
        {"site": "pilot:on_goal:speed = 2 * message.data", "path": "pilot.py", "line": 3, "score": 1.0}
    ],
    "repair": {
        "accepted": True,
        "patch": ".tarl/patches/pilot.patch",
        "edits": [{"path": "pilot.py", "line": 3, "code": "2", "value": 3.0}],
    },
}


def workspace(folder: Path) -> Path:
    (folder / "pilot.py").write_text(NODE, "utf-8")
    (folder / "difflib.py").write_text('open("executed", "w")\n', "utf-8")  # no code of a workspace may run
    results = folder / ".tarl" / "results"
    results.mkdir(parents=True)
    (results / "pilot.json").write_text(json.dumps(RESULT), "utf-8")
    patches = folder / ".tarl" / "patches"
    patches.mkdir()
    (patches / "pilot.patch").write_text("no patch\n", "utf-8")
    return folder


@pytest_lsp.fixture(config=ClientServerConfig(server_command=[sys.executable, "-m", "pytest_tarl", "lsp"]))
async def client(lsp_client: LanguageClient, tmp_path: Path) -> AsyncIterator[None]:
    root = workspace(tmp_path)
    for name in (lsp.WORKSPACE_CODE_LENS_REFRESH, lsp.WORKSPACE_INLAY_HINT_REFRESH):
        lsp_client.feature(name)(lambda *_: None)
    await lsp_client.initialize_session(
        lsp.InitializeParams(
            capabilities=client_capabilities("visual-studio-code"),
            workspace_folders=[lsp.WorkspaceFolder(root.as_uri(), "robot")],
        )
    )
    yield
    await lsp_client.shutdown_session()


def uri(folder: Path) -> str:
    return (folder / "pilot.py").as_uri()


async def diagnostics(client: LanguageClient, where: str, count: int) -> list[lsp.Diagnostic]:
    """Wait until a file has this number of diagnostics."""
    async with asyncio.timeout(60) if sys.version_info >= (3, 11) else _patient():
        while len(client.diagnostics.get(where, [])) != count:
            await client.wait_for_notification(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    return sorted(client.diagnostics[where], key=lambda one: str(one.code))


class _patient:  # noqa: N801 - stands for asyncio.timeout on Python 3.10
    async def __aenter__(self) -> None: ...

    async def __aexit__(self, *_: object) -> None: ...


def opened(client: LanguageClient, where: str, text: str) -> None:
    client.text_document_did_open(
        lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(where, "python", 1, text))
    )


def typed(client: LanguageClient, where: str, text: str, version: int = 2) -> None:
    client.text_document_did_change(
        lsp.DidChangeTextDocumentParams(
            lsp.VersionedTextDocumentIdentifier(version, where),
            [lsp.TextDocumentContentChangeWholeDocument(text)],
        )
    )


async def test_a_flow_is_a_diagnostic_that_lists_its_statements(
    client: LanguageClient, tmp_path: Path
) -> None:
    found = await diagnostics(client, uri(tmp_path), 2)
    assert [one.code for one in found] == ["TARL101", "TARL102"]
    assert found[0].range.start == lsp.Position(PUBLISH, 8)
    chain = [one.message for one in found[0].related_information or []]
    assert "assign: speed = 2 * message.data" in chain
    assert not (tmp_path / "executed").exists()


async def test_the_unsaved_buffer_is_linted_instead_of_the_file(
    client: LanguageClient, tmp_path: Path
) -> None:
    where = uri(tmp_path)
    await diagnostics(client, where, 2)
    opened(client, where, NODE)
    typed(client, where, NODE.replace('rospy.Subscriber("/stop", Float64, on_stop)\n', ""))
    (left,) = await diagnostics(client, where, 1)
    assert left.code == "TARL101"
    typed(client, where, NODE + "def broken(:\n", 3)
    (error,) = await diagnostics(client, where, 1)
    while error.code != "TARL001":
        await client.wait_for_notification(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        (error,) = client.diagnostics[where]
    assert error.severity == lsp.DiagnosticSeverity.Error


async def test_edit_of_a_shared_file_updates_all_its_programs(client: LanguageClient, tmp_path: Path) -> None:
    await diagnostics(client, uri(tmp_path), 2)
    node = "from shared import scaled\n" + NODE.replace("2 * message.data", "scaled(message.data)")
    node = node.replace("rospy.spin()", 'if __name__ == "__main__":\n    rospy.spin()')
    shared = tmp_path / "shared.py"
    shared.write_text("def scaled(value):\n    return 2 * value\n", "utf-8")
    nodes = [tmp_path / f"node{number}.py" for number in range(3)]
    for path in nodes:
        path.write_text(node, "utf-8")
    opened(client, shared.as_uri(), shared.read_text("utf-8"))
    for path in nodes:
        await diagnostics(client, path.as_uri(), 2)
    typed(client, shared.as_uri(), "def scaled(value):\n    return 2\n")
    for path in nodes:
        (left,) = await diagnostics(client, path.as_uri(), 1)
        assert left.code == "TARL102"


async def test_columns_count_utf16_units(client: LanguageClient, tmp_path: Path) -> None:
    where = uri(tmp_path)
    await diagnostics(client, where, 2)
    opened(client, where, NODE)
    moved = NODE.replace("        out.publish(speed)", '        "🤖🤖"; out.publish(speed)')
    typed(client, where, moved)
    while True:
        found = await diagnostics(client, where, 2)
        if found[0].range.start.character != 8:
            break
        await client.wait_for_notification(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    assert found[0].range.start == lsp.Position(PUBLISH, 16)


async def test_code_lens_lists_the_topics_behind_a_publish_call(
    client: LanguageClient, tmp_path: Path
) -> None:
    await diagnostics(client, uri(tmp_path), 2)
    (lens,) = (
        await client.text_document_code_lens_async(
            lsp.CodeLensParams(lsp.TextDocumentIdentifier(uri(tmp_path)))
        )
        or []
    )
    assert lens.command is not None
    assert lens.command.title == "data of /goal, decided by /stop"
    assert lens.range.start.line == PUBLISH


async def test_hovers_and_inlay_hints_show_the_recorded_figures(
    client: LanguageClient, tmp_path: Path
) -> None:
    where = lsp.TextDocumentIdentifier(uri(tmp_path))
    await diagnostics(client, where.uri, 2)
    hover = await client.text_document_hover_async(lsp.HoverParams(where, lsp.Position(SPEED, 6)))
    assert hover is not None
    assert isinstance(hover.contents, lsp.MarkupContent)
    assert "| `test_pilot.py::test_arrives` | mud | 9 | 2.5 | -6.5 | 1 |" in hover.contents.value
    assert await client.text_document_hover_async(lsp.HoverParams(where, lsp.Position(0, 0))) is None
    whole = lsp.Range(lsp.Position(0, 0), lsp.Position(100, 0))
    (hint,) = await client.text_document_inlay_hint_async(lsp.InlayHintParams(where, whole)) or []
    assert (hint.label, hint.position.line) == ("  #1 mud -6.5", SPEED)


async def actions(client: LanguageClient, folder: Path) -> dict[str, lsp.CodeAction]:
    where = lsp.Range(lsp.Position(PUBLISH, 8), lsp.Position(PUBLISH, 10))
    asked = lsp.CodeActionParams(lsp.TextDocumentIdentifier(uri(folder)), where, lsp.CodeActionContext([]))
    found = await client.text_document_code_action_async(asked) or []
    return {one.title: one if isinstance(one, lsp.CodeAction) else reread(one) for one in found}


def reread(misread: lsp.Command) -> lsp.CodeAction:
    """Return an action with a command, which lsprotocol's client reads as a command with a text of the command."""
    command = ast.literal_eval(misread.command)
    return lsp.CodeAction(misread.title, command=lsp.Command(**command))


async def test_a_finding_is_ignored_by_a_comment(client: LanguageClient, tmp_path: Path) -> None:
    where = uri(tmp_path)
    await diagnostics(client, where, 2)
    edit = (await actions(client, tmp_path))["Ignore TARL101 on this line"].edit
    assert edit is not None
    assert edit.changes is not None
    (change,) = edit.changes[where]
    assert change.new_text == "  # tarl: ignore[TARL101]"
    assert change.range.start == lsp.Position(PUBLISH, len("        out.publish(speed)"))
    opened(client, where, NODE)
    typed(client, where, NODE.replace("out.publish(speed)", f"out.publish(speed){change.new_text}"))
    (left,) = await diagnostics(client, where, 1)
    assert left.code == "TARL102"
    edit = (await actions(client, tmp_path))["Ignore TARL102 on this line"].edit
    assert edit is not None
    assert edit.changes is not None
    assert edit.changes[where][0].new_text == ", TARL102"


async def executed(client: LanguageClient, command: lsp.Command | None) -> None:
    assert command is not None
    asked = lsp.ExecuteCommandParams(command.command, arguments=command.arguments)
    await client.workspace_execute_command_async(asked)


async def test_a_finding_is_accepted_into_the_baseline(client: LanguageClient, tmp_path: Path) -> None:
    where = uri(tmp_path)
    await diagnostics(client, where, 2)
    await executed(client, (await actions(client, tmp_path))["Accept this TARL101 into the baseline"].command)
    accepted = json.loads((tmp_path / "tarl-flows.json").read_text("utf-8"))
    assert [flow["source"] for flow in accepted["flows"]] == ["/goal"]
    hints = [one.code for one in client.diagnostics[where] if one.severity == lsp.DiagnosticSeverity.Hint]
    assert hints == ["TARL101"]
    assert "Accept this TARL101 into the baseline" not in await actions(client, tmp_path)


async def test_one_sentence_says_that_a_repair_does_not_fit_its_file(
    client: LanguageClient, tmp_path: Path
) -> None:
    await diagnostics(client, uri(tmp_path), 2)
    await executed(client, (await actions(client, tmp_path))["Apply the repair pilot.patch"].command)
    assert "pilot.patch" in client.messages[-1].message
    assert (tmp_path / "pilot.py").read_text("utf-8") == NODE


async def test_invalid_settings_are_reported_once(client: LanguageClient, tmp_path: Path) -> None:
    where = uri(tmp_path)
    await diagnostics(client, where, 2)
    (tmp_path / "pyproject.toml").write_text("[tool.tarl-lint]\nselct = []\n", "utf-8")
    opened(client, where, NODE)
    await client.wait_for_notification(lsp.WINDOW_SHOW_MESSAGE)
    assert "selct" in client.messages[-1].message
