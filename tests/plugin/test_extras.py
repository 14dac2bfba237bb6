"""The command that installs an extra uses the source from which TARL was installed."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from pytest_tarl import extras


@pytest.mark.parametrize(
    ("record", "command"),
    [
        (None, 'pip install "tarl[ros]"'),  # from an index
        ({"url": "file:///home/me/tarl%20x", "dir_info": {}}, 'pip install "/home/me/tarl x[ros]"'),
        (
            {"url": "file:///home/me/tarl", "dir_info": {"editable": True}},
            'pip install --editable "/home/me/tarl[ros]"',
        ),
        ({"url": "file:///tmp/tarl-1-py3-none-any.whl", "archive_info": {}}, 'pip install "tarl[ros]"'),
        ({"url": "https://example.org/tarl.git", "vcs_info": {"vcs": "git"}}, 'pip install "tarl[ros]"'),
        ("no record of pip", 'pip install "tarl[ros]"'),
    ],
)
def test_the_install_command_uses_the_source_tree_of_tarl(
    monkeypatch: pytest.MonkeyPatch, record: object, command: str
) -> None:
    text = None if record is None else json.dumps(record)
    monkeypatch.setattr(extras, "distribution", lambda _: SimpleNamespace(read_text=lambda _: text))
    assert extras.install_command("ros") == command
