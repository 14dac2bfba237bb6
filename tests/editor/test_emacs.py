"""The settings for Emacs in docs/editor.md, used by a real Emacs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.editor.test_server import PUBLISH, workspace

DOCS = Path(__file__).parents[2] / "docs" / "editor.md"
WAIT = 100  # s; a loaded machine needs long for the start of both programs

# Opens a file, waits for its diagnostics, and prints them and the titles of the quick fixes of a line.
SESSION = """
(setq eglot-sync-connect {wait})
(find-file "{file}")
(python-mode)
(call-interactively 'eglot)
(with-timeout ({wait} (princ "no diagnostics"))
  (while (not (flymake-diagnostics)) (flymake-start) (accept-process-output nil 0.2)))
(dolist (found (flymake-diagnostics))
  (princ (format "diagnostic %s: %s\\n"
                 (line-number-at-pos (flymake-diagnostic-beg found)) (flymake-diagnostic-text found))))
(goto-char (point-min))
(forward-line {line})
(dolist (action (append (eglot-code-actions (line-beginning-position) (line-end-position)) nil))
  (princ (format "action %s\\n" (plist-get action :title))))
(eglot-shutdown-all)
"""


def emacs(*asked: str, **more: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    command = ["emacs", "--batch", "--eval", "(progn (require 'package) (package-initialize))", *asked]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=3 * WAIT,
        check=False,
        env=os.environ | {"PATH": path} | more,
    )


def test_emacs_shows_findings_and_offers_quick_fixes(tmp_path: Path) -> None:
    if shutil.which("emacs") is None or emacs("--eval", "(require 'eglot)").returncode != 0:
        pytest.skip("needs Emacs with Eglot: apt-get install emacs-nox elpa-eglot")
    (settings,) = re.findall(r"```lisp\n(.*?)```", DOCS.read_text("utf-8"), re.DOTALL)
    workspace(tmp_path)
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    session = tmp_path / "session.el"
    session.write_text(
        settings + SESSION.format(wait=WAIT, file=tmp_path / "pilot.py", line=PUBLISH), "utf-8"
    )
    result = emacs("--eval", "(require 'eglot)", "--load", str(session))
    assert (
        f"diagnostic {PUBLISH + 1}: tarl-lint [TARL101]: /goal (Float64) reaches /wheels" in result.stdout
    ), result.stdout + result.stderr
    assert "action Ignore TARL101 on this line" in result.stdout
    assert "action Accept this TARL101 into the baseline" in result.stdout
