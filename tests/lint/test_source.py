import codecs

import pytest

from tarl_lint.read.source import Module, SourceError, parse


def parsed(data):
    return parse("pkg/node.py", data, "pkg.node")


def test_file_becomes_a_named_module():
    module = parsed(b"x = 1\n")
    assert isinstance(module, Module)
    assert (module.path, module.name, module.text) == ("pkg/node.py", "pkg.node", "x = 1\n")


def test_the_encoding_that_the_file_declares_is_used():
    module = parsed("# -*- coding: latin-1 -*-\nname = 'Größe'\n".encode("latin-1"))
    assert isinstance(module, Module)
    assert "Größe" in module.text


@pytest.mark.parametrize("data", [codecs.BOM_UTF8 + b"x = 1\r\ny = 2\r\n", b"x = 1\ry = 2\r"])
def test_byte_order_marks_and_foreign_line_ends_are_removed(data):
    module = parsed(data)
    assert isinstance(module, Module)
    assert module.text == "x = 1\ny = 2\n"


@pytest.mark.parametrize(
    ("data", "line", "words"),
    [
        (b"x = 1\nprint 'ready'\n", 2, "Python 2"),
        (b"try:\n    pass\nexcept IOError, e:\n    pass\n", 3, "Python 2"),
        (b"def f(:\n    pass\n", 1, "not valid Python"),
        (b"x = 1\ny = '\0'\n", 2, "null byte"),
        (b"# coding: nonsense\n", 1, "encoding"),
        (b"x = 1\ny = '\xff'\n", 2, "not valid utf-8"),
        (b"x = " + b"(" * 5000 + b")" * 5000, 1, ""),
        (b"x = " + b"-" * 200_000 + b"1", 1, ""),
    ],
)
def test_a_syntax_error_gives_a_sentence_and_a_line(data, line, words):
    error = parsed(data)
    assert isinstance(error, SourceError)
    assert error.line == line
    assert words in error.message
    assert error.message.endswith(".")


def test_a_package_is_distinguished_from_a_module():
    module = parse("pkg/__init__.py", b"", "pkg")
    assert isinstance(module, Module)
    assert module.is_package


def test_notebook_is_recognised_even_as_valid_python():
    error = parse("a.ipynb", b'{"cells": []}', "a")
    assert isinstance(error, SourceError)
    assert "jupyter nbconvert --to script" in error.message
