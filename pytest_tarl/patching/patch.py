"""Write patches as unified diffs, for files with any line ending and encoding."""

from __future__ import annotations

import difflib
import hashlib
import io
import os
import re
import shlex
import shutil
import tokenize
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pytest_tarl.errors import RepairError
from pytest_tarl.files import advice_on, slug
from tarl_lint.files import write_atomically

Opcode = tuple[str, int, int, int, int]
CONTEXT = 3  # unchanged lines around a change
BASE = "paths are relative to"  # header key of the base folder
SEAL = "digest of all other lines"  # header key of the hash that detects edited or damaged patches
TITLE = "Repair by tarl "
PARTIAL = ".partial"  # suffix of files with a change that was rejected as a repair
QUOTE = b"| "  # prefix of each line of a PARTIAL file, so that other tools cannot apply the change
_NO_NEWLINE = "\\ No newline at end of file\n"


def unified_diff(
    originals: Mapping[Path, bytes], changed: Mapping[Path, str], root: Path, header: Sequence[str]
) -> str:
    """Return the diff from files' original bytes to their new texts, after a header of comment lines.

    Paths are relative to the top of the files' git repository or, without one, to `root`, because `git apply` silently
    skips other paths. Bytes that are not UTF-8 become surrogate characters, which `readable` replaces. Raise
    RepairError if the files are in several repositories, or if their encoding cannot represent the new text.
    """
    base = _base([path.resolve() for path in changed], root.resolve())
    texts = {
        path.resolve().relative_to(base).as_posix(): (originals[path], _encoded(path, originals[path], text))
        for path, text in sorted(changed.items())
    }
    return bytes_diff(texts, _shown(base, root.resolve()), header)


def bytes_diff(texts: Mapping[str, tuple[bytes, bytes]], base: str, header: Sequence[str]) -> str:
    """Return a diff; `texts` maps names relative to `base` to old and new bytes."""
    comments = [f"# {line}".rstrip() + "\n" for text in header for line in text.splitlines() or [""]]
    head = "".join((*comments, f"# {BASE}: {base}\n"))
    diffs = "".join(_file_diff(name, before, after) for name, (before, after) in texts.items())
    return f"{head}# {SEAL}: {seal((head + diffs).encode('utf-8', 'surrogateescape'))}\n{diffs}"


def seal(content: bytes) -> str:
    """Return the hash of a patch, without its own hash line."""
    return hashlib.sha256(content).hexdigest()


def readable(diff: str) -> str:
    """Return a printable diff, with replacement characters for bytes that are not UTF-8."""
    return diff.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def write(diff: str, folder: Path, test: str, drift: str | None) -> Path:
    """Write a patch atomically as `<test>-<drift>-<digest>.patch` and delete older ones. Raise RepairError."""
    content = diff.encode("utf-8", "surrogateescape")
    digest = hashlib.sha256(content).hexdigest()[:8]
    name = f"{slug(test)}-{slug(drift or 'online')}"
    path = folder / f"{name}-{digest}.patch"
    try:
        write_atomically(path, content, parents=True)
    except OSError as problem:
        raise RepairError(
            f"The patch {path} cannot be written ({problem.strerror}): {advice_on(problem)}"
        ) from problem
    (folder / f"{name}{PARTIAL}").unlink(missing_ok=True)
    for older in folder.glob(f"{name}-????????.patch"):
        if older != path:
            older.unlink()
            older.with_suffix(".sarif").unlink(missing_ok=True)
    return path


def write_partial(diff: str, folder: Path, test: str, drift: str | None) -> Path:
    """Write a rejected change with quoted lines. Raise RepairError."""
    content = b"".join(QUOTE + line for line in split_lines(diff.encode("utf-8", "surrogateescape")))
    path = folder / f"{slug(test)}-{slug(drift or 'online')}{PARTIAL}"
    try:
        write_atomically(path, content, parents=True)
    except OSError as problem:
        raise RepairError(f"{path} cannot be written ({problem.strerror}): {advice_on(problem)}") from problem
    return path


def unquoted(content: bytes) -> bytes:
    """Return a patch without the prefixes of `write_partial`."""
    if not content.startswith(QUOTE):
        return content
    return b"".join(line.removeprefix(QUOTE) for line in split_lines(content))


def apply_command(patch: Path, cwd: Path) -> str:
    """Return the shell command that applies a patch of `<root>/.tarl/patches` when run in `cwd`.

    In any other folder, the command fails because it does not find the patch.
    """
    here = cwd.resolve()
    text = patch.read_bytes().decode("utf-8", "surrogateescape")
    base = (patch.resolve().parents[2] / _stated_base(text)).resolve()
    if shutil.which("git") is None:
        return shlex.join(["patch", "-p1", "-d", _shown(base, here), "-i", str(patch.resolve())])
    # in a subfolder, git silently skips files outside it and exits with 0
    if base == here:
        return shlex.join(["git", "apply", _shown(patch.resolve(), here)])
    return shlex.join(["git", "-C", _shown(base, here), "apply", _shown(patch.resolve(), base)])


def blob_id(content: bytes) -> str:
    """Return git's blob id of a content."""
    return hashlib.sha1(b"blob %d\0" % len(content) + content, usedforsecurity=False).hexdigest()


def split_lines(content: bytes) -> list[bytes]:
    """Split lines as git does, after line feeds only."""
    return re.findall(rb"[^\n]*\n|[^\n]+", content)


def _base(files: Sequence[Path], root: Path) -> Path:
    """Return the folder that a patch's paths are relative to. Raise RepairError."""
    tops = {_git_top(file) for file in files}
    if len(tops) > 1:
        names = ", ".join(str(file) for file in files)
        raise RepairError(
            f"One patch cannot change files of several repositories ({names}): repair them one by one."
        )
    top = tops.pop()
    if top is not None:
        return top
    return (
        root if all(file.is_relative_to(root) for file in files) else Path(os.path.commonpath(files)).parent
    )


def _git_top(file: Path) -> Path | None:
    return next((folder for folder in file.parents if (folder / ".git").exists()), None)


def _shown(path: Path, start: Path) -> str:
    """Return a path relative to `start`."""
    return Path(os.path.relpath(path, start)).as_posix()


def _stated_base(text: str) -> str:
    """Return the base folder in a patch's header (default: ".")."""
    start = f"# {BASE}: "
    stated = (line.removeprefix(start) for line in text.split("\n") if line.startswith(start))
    return next(stated, ".")


def _encoded(path: Path, original: bytes, text: str) -> bytes:
    """Encode the new text in the file's encoding. Raise RepairError."""
    encoding, _ = tokenize.detect_encoding(io.BytesIO(original).readline)
    text = text.removeprefix("\ufeff")
    if b"\r\n" in original and "\r\n" not in text:
        text = _with_endings(original.decode(encoding), text)
    try:
        return text.encode(encoding)
    except UnicodeEncodeError as error:
        raise RepairError(
            f"{path} is encoded in {encoding}, which has no {text[error.start]!r}: rename the topic or sensor, or "
            "save the file as UTF-8."
        ) from error


def _with_endings(original: str, text: str) -> str:
    """Keep line endings; new lines get the most frequent one of the file."""
    before, after = _lines(original), _lines(text)
    usual = "\r\n" if original.count("\r\n") * 2 > original.count("\n") else "\n"
    bare = [line.replace("\r\n", "\n") for line in before]
    result: list[str] = []
    for tag, start, end, first, last in difflib.SequenceMatcher(
        None, bare, after, autojunk=False
    ).get_opcodes():
        new = [line.replace("\n", usual) for line in after[first:last]]
        result += before[start:end] if tag == "equal" else new
    return "".join(result)


def _file_diff(name: str, before: bytes, after: bytes) -> str:
    """Return the diff of one file; its `index` line enables git's three-way merge."""
    old, new = (_lines(content.decode("utf-8", "surrogateescape")) for content in (before, after))
    end = "\t" if " " in name else ""
    lines = [
        f"diff --git a/{name} b/{name}\n",
        f"index {blob_id(before)}..{blob_id(after)}\n",
        f"--- a/{name}{end}\n",
        f"+++ b/{name}{end}\n",
    ]
    matcher = difflib.SequenceMatcher(None, old, new, autojunk=False)
    for group in matcher.get_grouped_opcodes(CONTEXT):
        lines.append(_hunk_header(group))
        lines += _hunk(group, old, new)
    return "".join(lines)


def _hunk_header(group: Sequence[Opcode]) -> str:
    (_, old_start, _, new_start, _), (_, _, old_end, _, new_end) = group[0], group[-1]
    return f"@@ -{_range(old_start, old_end)} +{_range(new_start, new_end)} @@\n"


def _range(start: int, end: int) -> str:
    return f"{start + (end > start)},{end - start}"


def _hunk(group: Sequence[Opcode], old: Sequence[str], new: Sequence[str]) -> Iterator[str]:
    for tag, old_start, old_end, new_start, new_end in group:
        if tag == "equal":
            yield from (_line(" ", line) for line in old[old_start:old_end])
        else:
            yield from (_line("-", line) for line in old[old_start:old_end])
            yield from (_line("+", line) for line in new[new_start:new_end])


def _line(sign: str, line: str) -> str:
    return f"{sign}{line}" if line.endswith("\n") else f"{sign}{line}\n{_NO_NEWLINE}"


def _lines(text: str) -> list[str]:
    """Split lines as git does, after line feeds only."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)
