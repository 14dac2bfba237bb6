"""Helpers that find the hazards of one rule in texts."""

from textwrap import dedent

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config


def lines(code: str, *texts: str) -> list[int]:
    """Return the lines of the hazards of one rule in files a.py, b.py, ..."""
    modules = []
    for name, text in zip("abc", texts, strict=False):
        module = parse(f"{name}.py", dedent(text).strip("\n").encode(), name)
        assert isinstance(module, Module)
        modules.append(module)
    return [f.span.line for f in engine.lint(modules, Config(select=(code,))) if f.code == code]


def inside(text: str, body: str, depth: int) -> str:
    """Insert an indented body into a text."""
    return text.format(body="\n".join(" " * depth + line for line in dedent(body).strip().split("\n")))
