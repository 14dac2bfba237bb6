"""The fast tree walks find the same nodes as `ast.walk`."""

import ast
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.trees import children, outside_functions, walk

TEXTS = [
    Path(__file__).read_text(),
    Path(ast.__file__).read_text(),
    "match x:\n    case {'a': [1, *rest], **others} if (y := rest): pass\n    case P(q=1) | None as z: pass\n",
    "async def f(a, /, b: int = 1, *c, d=2, **e) -> str:\n    async with g() as h, i: yield f'{a!r:>{b}}'\n",
    "import a.b as c\nfrom . import d\nglobal e\nfor x in y:\n    del x[1:2, ::3]\nelse:\n    raise X from Y\n",
    "try: pass\nexcept (A, B) as c: pass\nelse: pass\nfinally: pass\nlambda *a: {**a, 'b': {*c}}\n",
]
if sys.version_info >= (3, 12):
    TEXTS.append("def f[T: int](x: T) -> T: return x\n")


def plain(nodes):
    """Drop operators and expression contexts, which the fast walks skip."""
    return [
        n
        for n in nodes
        if not isinstance(n, (ast.expr_context, ast.operator, ast.unaryop, ast.boolop, ast.cmpop))
    ]


@pytest.mark.parametrize("text", TEXTS)
def test_nodes_are_found_in_tree_order(text):
    tree = ast.parse(text)
    assert set(walk(tree)) == set(plain(ast.walk(tree)))
    for node in plain(ast.walk(tree)):
        assert children(node) == plain(ast.iter_child_nodes(node))


def test_functions_are_found_in_source_order():
    tree = ast.parse(TEXTS[1])
    lines = [n.lineno for n in walk(tree) if isinstance(n, (ast.FunctionDef, ast.ClassDef))]
    assert lines == sorted(lines)


def test_statements_outside_functions_include_those_inside_other_statements():
    text = """
        a = 1
        if b:
            c = 2
        else:
            d = 3
        try:
            e = 4
        except F:
            g = 5
        else:
            h = 6
        finally:
            i = 7
        match j:
            case 1:
                k = 8
        def no(): m = 9
        class No: n = 10
        with p: q = 11
    """
    found = outside_functions(ast.parse(dedent(text)).body)
    assert [n.value.value for n in found if isinstance(n, ast.Assign)] == [1, 2, 3, 4, 5, 6, 7, 8, 11]
