"""The language server: lint the workspace after changes, and answer the editor's requests from the last result."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Iterable
from functools import partial
from importlib.metadata import version
from pathlib import Path

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.uris import to_fs_path

from pytest_tarl.editor import diagnostics, fixes, recorded
from pytest_tarl.editor.positions import Places
from pytest_tarl.extras import missing_extra
from tarl_lint.editing import Result, Superseded, Workspace
from tarl_lint.errors import LintError

# patch → lines to show; raises TarlError if the patch no longer fits the files
Apply = Callable[[Path], Iterable[str]]
PAUSE = 0.15  # seconds without typing before the workspace is linted
CHANGES = (
    types.TEXT_DOCUMENT_DID_OPEN,
    types.TEXT_DOCUMENT_DID_CHANGE,
    types.TEXT_DOCUMENT_DID_SAVE,
    types.TEXT_DOCUMENT_DID_CLOSE,
    types.WORKSPACE_DID_CHANGE_WATCHED_FILES,
)


class Server(LanguageServer):
    """A workspace in an editor. State changes only in the event loop; threads lint and read files."""

    def __init__(self, apply: Apply) -> None:
        super().__init__("tarl", version("tarl"), types.TextDocumentSyncKind.Incremental)
        self.apply = apply
        self.root = Path.cwd()
        self.linted: Workspace | None = None
        self.result: Result | None = None
        self.places = Places(self.root, {})
        # positions in the file contents whose diagnostics were published last
        self.shown_in = self.places
        self.kept = recorded.Recorded()
        self.shown: dict[str, list[types.Diagnostic]] = {}
        self._waiting: asyncio.Task[None] | None = None
        self._running = asyncio.Lock()
        self._changes = 0
        self._problem = ""

    def begin(self, root: Path) -> None:
        """Set the root folder of the workspace."""
        self.root = root
        os.chdir(root)  # the linter names files relative to the working directory
        self.linted = Workspace([root])

    def changed(self) -> None:
        """Lint after PAUSE; each further change restarts the wait."""
        self._changes += 1
        if self._waiting is not None:
            self._waiting.cancel()
        self._waiting = asyncio.ensure_future(self._later())

    async def _later(self) -> None:
        await asyncio.sleep(PAUSE)
        await asyncio.shield(self.lint())

    async def lint(self) -> None:
        """Lint the workspace with the open buffers, and publish changed diagnostics.

        After another change, stop before the next program and start again. Files whose findings are final get their
        diagnostics while other programs are still being analysed.
        """
        if self.linted is None:
            return
        async with self._running:
            changes = self._changes
            loop = asyncio.get_running_loop()

            def early(result: Result, settled: frozenset[str]) -> None:
                if self._changes == changes:
                    loop.call_soon_threadsafe(self._publish_some, result, settled)

            lint = partial(self.linted.lint, self.buffers(), lambda: self._changes == changes, early)
            try:
                result = await loop.run_in_executor(None, lint)
            except Superseded:
                return
            except LintError as error:
                self.say(str(error))
                return
            self._problem = ""
            self.kept = await loop.run_in_executor(None, recorded.read, self.root)
            self.result, self.places = result, Places(self.root, result.texts)
            self.shown_in = self.places
            self._publish(diagnostics.diagnostics(result, self.places))
        self._refresh()

    def buffers(self) -> dict[Path, str]:
        """Return the texts of the open Python files below the root."""
        found = {}
        for uri, document in self.workspace.text_documents.items():
            path = self.path(uri)
            if path is not None and path.suffix == ".py":
                found[path] = document.source
        return found

    def path(self, uri: str) -> Path | None:
        """Return the path of a URI, or None if it is not a file below the root."""
        place = to_fs_path(uri)
        path = Path(place) if place else None
        return path if path is not None and path.is_relative_to(self.root) else None

    def shown_path(self, uri: str) -> str | None:
        """Return the path that the linter uses for a URI, or None if it is not below the root."""
        path = self.path(uri)
        return path.relative_to(self.root).as_posix() if path is not None else None

    def say(self, sentence: str) -> None:
        """Show a warning, at most once until linting succeeds again."""
        if sentence != self._problem:
            self._problem = sentence
            self.window_show_message(types.ShowMessageParams(types.MessageType.Warning, f"tarl: {sentence}"))

    def _publish(self, found: dict[str, list[types.Diagnostic]]) -> None:
        for path in sorted({*found, *self.shown}):
            self._show(path, found.get(path, []))

    def _publish_some(self, result: Result, settled: frozenset[str]) -> None:
        """Publish the diagnostics of some files.

        Other files keep theirs: their text may have changed, so their diagnostics may be outdated.
        """
        self.shown_in = Places(self.root, result.texts)
        found = diagnostics.diagnostics(result, self.shown_in)
        for path in sorted({*found, *self.shown} & settled):
            self._show(path, found.get(path, []))

    def _show(self, path: str, now: list[types.Diagnostic]) -> None:
        if now != self.shown.get(path, []):
            self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(self.places.uri(path), now))
        self.shown.pop(path, None)
        if now:
            self.shown[path] = now

    def _refresh(self) -> None:
        wants = self.client_capabilities.workspace
        if wants is not None and wants.code_lens is not None and wants.code_lens.refresh_support:
            self.workspace_code_lens_refresh(None, _heard)
        if wants is not None and wants.inlay_hint is not None and wants.inlay_hint.refresh_support:
            self.workspace_inlay_hint_refresh(None, _heard)


def _heard(_: object) -> None:
    """Ignore the client's response to a refresh request."""


def server(apply: Apply) -> Server:
    """Return a server with its features; `apply` applies a patch and returns the lines to show."""
    made = Server(apply)

    @made.feature(types.INITIALIZED)
    async def begun(ls: Server, _: types.InitializedParams) -> None:
        ls.begin(_root(ls))
        await ls.lint()

    def changed(ls: Server, _: object) -> None:
        ls.changed()

    for event in CHANGES:
        made.feature(event)(changed)
    _answers(made)
    _commands(made)
    return made


def _root(ls: Server) -> Path:
    places = [to_fs_path(folder.uri) for folder in ls.workspace.folders.values()] or [ls.workspace.root_path]
    return next((Path(place).resolve() for place in places if place), Path.cwd())


def _answers(made: Server) -> None:
    @made.feature(types.TEXT_DOCUMENT_CODE_LENS, types.CodeLensOptions(resolve_provider=False))
    def lenses(ls: Server, asked: types.CodeLensParams) -> list[types.CodeLens]:
        path = ls.shown_path(asked.text_document.uri)
        return diagnostics.lenses(ls.result, path, ls.places) if path is not None and ls.result else []

    @made.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(ls: Server, asked: types.HoverParams) -> types.Hover | None:
        path = ls.shown_path(asked.text_document.uri)
        if path is None or ls.result is None:
            return None
        line = asked.position.line + 1
        for site, step in recorded.steps(ls.result, path).items():
            figures = ls.kept.by_site.get(site)
            if figures and step.span.line <= line <= step.span.end_line:
                text = types.MarkupContent(types.MarkupKind.Markdown, recorded.hover(figures))
                return types.Hover(text, ls.places.range(step.span))
        return None

    @made.feature(types.TEXT_DOCUMENT_INLAY_HINT)
    def hints(ls: Server, asked: types.InlayHintParams) -> list[types.InlayHint]:
        path = ls.shown_path(asked.text_document.uri)
        if path is None or ls.result is None:
            return []
        found = []
        for site, step in recorded.steps(ls.result, path).items():
            text = recorded.hint(ls.kept.by_site.get(site, ()))
            if text and asked.range.start.line < step.span.end_line <= asked.range.end.line + 1:
                place = ls.places.end_of_line(path, step.span.end_line)
                found.append(types.InlayHint(place, f"  {text}", padding_left=True))
        return sorted(found, key=lambda one: one.position)

    @made.feature(
        types.TEXT_DOCUMENT_CODE_ACTION,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    )
    def actions(ls: Server, asked: types.CodeActionParams) -> list[types.CodeAction]:
        uri = asked.text_document.uri
        path = ls.shown_path(uri)
        if path is None:
            return []
        here = [one for one in ls.shown.get(path, []) if _touches(one.range, asked.range)]
        return fixes.fixes(uri, path, here, ls.kept.patches.get(path, ()), ls.shown_in)


def _touches(first: types.Range, second: types.Range) -> bool:
    return first.start.line <= second.end.line and second.start.line <= first.end.line


def _commands(made: Server) -> None:
    @made.command(fixes.ACCEPT)
    async def accept(ls: Server, fingerprint: str) -> None:
        if ls.linted is None or ls.result is None:
            return
        try:
            path = ls.linted.accept(fingerprint, ls.result)
        except LintError as error:
            ls.say(str(error))
            return
        ls.say(f"accepted the finding in {path.name}: commit this file.")
        await ls.lint()

    @made.command(fixes.APPLY)
    async def apply(ls: Server, patch: str) -> None:
        from pytest_tarl.errors import TarlError

        sentence = missing_extra("Applying a repair")
        if sentence is not None:
            ls.say(sentence)
            return
        try:
            _tell(ls, ls.apply(Path(patch)))
        except TarlError as error:
            ls.say(str(error))
        await ls.lint()


def _tell(ls: Server, lines: Iterable[str]) -> None:
    ls.window_show_message(types.ShowMessageParams(types.MessageType.Info, "\n".join(lines)))


def main(apply: Apply) -> int:
    """Serve one editor over standard input and output until it exits."""
    server(apply).start_io()
    return 0
