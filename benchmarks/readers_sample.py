"""Draw random sentences from everything that users and contributors read, to judge the wording.

    python benchmarks/readers_sample.py [--sentences 100] [--seed 0]

The pool holds the sentences of README, docs, rule pages, docstrings, comments, messages and help texts, page
templates and names of tests. Each kind of text has the same share of the sample, since there are far more docstrings
than messages.
"""

from __future__ import annotations

import argparse
import ast
import io
import random
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CODE = ("tarl_lint", "pytest_tarl", "website", "benchmarks")
SHORTEST = 4  # minimum number of words; shorter texts are labels
NO_PROSE = re.compile(
    r"^(noqa|type:|fmt:|!/)|\bimport \w+ (from|import)\b|^(\{[^}]*\}\W*)+$"
)  # directives, embedded code, layouts


def main() -> None:
    """Print the sample, one sentence a line: number, kind, place, text."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--sentences", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    for number, (kind, place, sentence) in enumerate(sample(ROOT, asked.sentences, asked.seed), 1):
        print(f"{number}. [{kind}] {place}: {sentence}")


def sample(root: Path, sentences: int, seed: int) -> list[tuple[str, str, str]]:
    """Return a stratified random sample as (kind, place, sentence); the same tree and seed give the same sample."""
    pools: dict[str, list[tuple[str, str, str]]] = {}
    for kind, place, sentence in sorted(set(everything(root))):
        pools.setdefault(kind, []).append((kind, place, sentence))
    rng = random.Random(seed)
    for pool in pools.values():
        rng.shuffle(pool)
    drawn: list[tuple[str, str, str]] = []
    while len(drawn) < sentences and any(pools.values()):
        for pool in pools.values():
            if pool and len(drawn) < sentences:
                drawn.append(pool.pop())
    return drawn


def everything(root: Path) -> Iterator[tuple[str, str, str]]:
    """Yield (kind, place, sentence) for every sentence of the pool."""
    pages = [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("examples/*.md")]
    for path in sorted(pages):
        kind = "rule page" if path.parent.name == "rules" else "docs"
        yield from _of(kind, path.relative_to(root).as_posix(), _prose(path.read_text()))
    for path in sorted(one for folder in CODE for one in root.glob(f"{folder}/**/*.py")):
        yield from _of_code(path.relative_to(root).as_posix(), path.read_text())
    for path in sorted([*root.glob("pytest_tarl/**/*.html"), *root.glob("pytest_tarl/**/*.jinja")]):
        text = re.sub(
            r"<(script|style).*?</\1>|\{[{%#].*?[}%#]\}|<[^>]*>", "\n", path.read_text(), flags=re.DOTALL
        )
        yield from _of("page", path.relative_to(root).as_posix(), text.split("\n"))
    for path in sorted(root.glob("tests/**/test_*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                yield "test name", path.relative_to(root).as_posix(), node.name


def _of_code(place: str, text: str) -> Iterator[tuple[str, str, str]]:
    tree = ast.parse(text)
    docstrings: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and node.body:
            first = node.body[0]
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                docstrings.add(id(first.value))
                yield from _of("docstring", place, (ast.get_docstring(node) or "").split("\n\n"))
    joined = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]
    parts = {id(part) for node in joined for part in node.values}
    for node in joined:
        yield from _of("message", place, [ast.unparse(node)[2:-1]])
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in docstrings | parts
        ):
            yield from _of("message", place, [node.value])
    block: list[str] = []
    last = 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            # a comment at the end of a line of code is a block of its own
            beside = bool(token.line[: token.start[1]].strip())
            if block and (beside or token.start[0] != last + 1):
                yield from _of("comment", place, [" ".join(block)])
                block = []
            block.append(token.string.lstrip("#: "))
            last = -1 if beside else token.start[0]
    yield from _of("comment", place, [" ".join(block)])


def _prose(text: str) -> list[str]:
    """Return the paragraphs and table cells of a Markdown page, without code blocks."""
    text = re.sub(r"^ *```.*?^ *```", "", text, flags=re.DOTALL | re.MULTILINE)
    kept = [line for line in text.split("\n") if not line.startswith(("    ", "#"))]
    text = re.sub(r"\n(?= *(?:[-|>]|\d+\. ))", "\n\n", "\n".join(kept))
    return [cell for paragraph in text.split("\n\n") for cell in re.split(r" \| |^\||\|$", paragraph)]


def _of(kind: str, place: str, paragraphs: list[str]) -> Iterator[tuple[str, str, str]]:
    for paragraph in paragraphs:
        flat = " ".join(paragraph.split()).lstrip("->* ")
        for sentence in re.split(r"(?<=[.?!])\s+(?=[A-Z`*\[])", flat):
            words = re.findall(r"[A-Za-z][a-z']*", sentence)
            if len(words) >= SHORTEST and " " in sentence and not NO_PROSE.search(sentence):
                yield kind, place, sentence


if __name__ == "__main__":
    main()
