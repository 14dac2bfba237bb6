"""Draw random sentences from everything that users and contributors read, to judge the wording.

    python benchmarks/readers_sample.py [--sentences 100] [--seed 0] [--beside PROJECT... --key KEY.json]

The pool has the sentences of README, docs, rule pages, docstrings, comments, messages, help texts and page templates,
and the names of tests. Each kind of text has the same share of the sample, because there are far more docstrings than
messages.

How many sentences have to be read twice depends on the reader. With `--beside`, equally many sentences of each other
project (an unpacked source distribution) are drawn in the same way. All are printed in random order without their
places, so that the reader does not know which project a sentence comes from. KEY.json then has [project, kind, place]
for each number.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import random
import re
import tokenize
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

Sentence = tuple[str, str, str]  # kind, place, text
Pools = dict[str, list[Sentence]]  # kind → sentences

ROOT = Path(__file__).resolve().parents[1]
CODE = ("tarl_lint", "pytest_tarl", "website", "benchmarks")
SHORTEST = 4  # minimum number of words; shorter texts are labels
NO_PROSE = re.compile(
    r"^(noqa|type:|fmt:|!/)|\bimport \w+ (from|import)\b|^(\{[^}]*\}\W*)+$"
)  # directives, embedded code, layouts


def main() -> None:
    """Print the sample, one sentence per line: number, kind, place, text."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--sentences", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--beside", type=Path, nargs="+", default=[], metavar="PROJECT")
    parser.add_argument("--key", type=Path)
    asked = parser.parse_args()
    if bool(asked.beside) != bool(asked.key):
        parser.error("--beside and --key are used together")
    if not asked.beside:
        for number, (kind, place, sentence) in enumerate(sample(ROOT, asked.sentences, asked.seed), 1):
            print(f"{number}. [{kind}] {place}: {sentence}")
        return
    projects = {"tarl": pools_of(ROOT, CODE)}
    projects |= {other.resolve().name: pools_of(other, ("**",)) for other in asked.beside}
    key = []
    for number, (project, (kind, place, sentence)) in enumerate(
        blind(projects, asked.sentences, asked.seed), 1
    ):
        key.append([project, kind, place])
        print(f"{number}. [{kind}] {sentence}")
    asked.key.write_text(json.dumps(key, indent=1))


def blind(projects: Mapping[str, Pools], sentences: int, seed: int) -> list[tuple[str, Sentence]]:
    """Return samples of all projects in random order, only of the kinds of text that every project has."""
    shared = sorted(set.intersection(*(set(pools) for pools in projects.values())))
    drawn = [
        (project, one)
        for project, pools in projects.items()
        for one in draw({kind: pools[kind] for kind in shared}, sentences, seed)
    ]
    random.Random(seed).shuffle(drawn)
    return drawn


def sample(root: Path, sentences: int, seed: int) -> list[Sentence]:
    """Return a stratified random sample of (kind, place, sentence); the same tree and seed give the same one."""
    return draw(pools_of(root, CODE), sentences, seed)


def pools_of(root: Path, code: Sequence[str]) -> Pools:
    """Return a project's sentences by kind; `code` names its folders of Python files."""
    pools: Pools = {}
    for kind, place, sentence in sorted(set(everything(root, code))):
        pools.setdefault(kind, []).append((kind, place, sentence))
    return pools


def draw(pools: Pools, sentences: int, seed: int) -> list[Sentence]:
    """Draw sentences without replacement, from each kind in turn."""
    rng = random.Random(seed)
    left = {kind: list(pool) for kind, pool in pools.items()}
    for pool in left.values():
        rng.shuffle(pool)
    drawn: list[Sentence] = []
    while len(drawn) < sentences and any(left.values()):
        for pool in left.values():
            if pool and len(drawn) < sentences:
                drawn.append(pool.pop())
    return drawn


def everything(root: Path, code: Sequence[str]) -> Iterator[Sentence]:
    """Yield (kind, place, sentence) for every sentence of the pool; `code` names the folders of Python files."""
    pages = [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("examples/*.md")]
    for path in sorted(pages):
        kind = "rule page" if path.parent.name == "rules" else "docs"
        yield from _of(kind, path.relative_to(root).as_posix(), _prose(path.read_text()))
    for path in sorted([*root.glob("*.rst"), *root.glob("doc*/**/*.rst")]):
        yield from _of("docs", path.relative_to(root).as_posix(), _prose_of_rst(path.read_text()))
    for path in sorted({one for folder in code for one in root.glob(f"{folder}/**/*.py")}):
        if code is CODE or not {"tests", "testing", "test", "resources"} & set(path.relative_to(root).parts):
            yield from _of_code(path.relative_to(root).as_posix(), path.read_text())
    for path in sorted([*root.glob("pytest_tarl/**/*.html"), *root.glob("pytest_tarl/**/*.jinja")]):
        text = re.sub(
            r"<(script|style).*?</\1>|\{[{%#].*?[}%#]\}|<[^>]*>", "\n", path.read_text(), flags=re.DOTALL
        )
        yield from _of("page", path.relative_to(root).as_posix(), text.split("\n"))
    for path in sorted([*root.glob("tests/**/test_*.py"), *root.glob("testing/**/test_*.py")]):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                yield "test name", path.relative_to(root).as_posix(), node.name


def _of_code(place: str, text: str) -> Iterator[Sentence]:
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
            # a comment at the end of a line of code is a separate block
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


def _prose_of_rst(text: str) -> list[str]:
    """Return the paragraphs of a reStructuredText page, without directives, code blocks and headings."""
    kept = [line for line in text.split("\n") if not line.startswith((" ", ".."))]
    paragraphs = "\n".join(kept).split("\n\n")
    return [one for one in paragraphs if not re.search(r"^([=~^#*+-])\1{3,}$", one, flags=re.MULTILINE)]


def _of(kind: str, place: str, paragraphs: list[str]) -> Iterator[Sentence]:
    for paragraph in paragraphs:
        flat = " ".join(paragraph.split()).lstrip("->* ")
        for sentence in re.split(r"(?<=[.?!])\s+(?=[A-Z`*\[])", flat):
            words = re.findall(r"[A-Za-z][a-z']*", sentence)
            if len(words) >= SHORTEST and " " in sentence and not NO_PROSE.search(sentence):
                yield kind, place, sentence


if __name__ == "__main__":
    main()
