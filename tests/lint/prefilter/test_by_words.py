"""Which modules take part in flows, by their words and imports."""

from __future__ import annotations

import pytest

from tarl_lint.prefilter.by_words import (
    code,
    concerned,
    endpoint_words,
    groups,
    mentioning,
    reached,
    relevant,
)
from tarl_lint.read.source import Script
from tarl_lint.settings.config import Config
from tarl_lint.settings.schema import Wrapper

PUBLISHER = "import rospy\npub = rospy.Publisher('a', F)\n"


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("x = 1  # publish\ny = 2", "x = 1  \ny = 2"),
        ("x = 'a # b'", "x = 'a # b'"),
        ('x = "a # \\" b"  # c', 'x = "a # \\" b"  '),
        ('"""Prose."""\nx = 1', "\nx = 1"),
        ("'''Prose\nof two lines'''\nx = 1", "\nx = 1"),
        ('x = f"""kept {y}"""', 'x = f"""kept {y}"""'),
        ("x = rf'''kept {y}'''", "x = rf'''kept {y}'''"),
        ('x = ""  # gone', 'x = ""  '),
        ("x = '\\\n# kept'", "x = '\\\n# kept'"),
    ],
)
def test_comments_and_prose_do_not_count_as_code(text, kept):
    assert code(text) == kept


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("rospy.Subscriber('a', F, f)", True),
        ("node.create_subscription(F, 'a', f, 1)", True),
        ("rospy.Service('a', F, f)", True),
        ("pub.publish(1)", True),
        ("from rospy import Publisher", True),
        ("robot_state_publisher = 1", False),
        ("published = 1", False),
        ("Services = 1", False),
        ("# pub.publish(1)", False),
        ('"""A Publisher."""', False),
        ("tf.lookupTransform(a, b)", False),
        ("rospy.ServiceProxy('a', F)", False),
    ],
)
def test_word_shows_that_a_module_may_subscribe_or_publish(text, found):
    assert endpoint_words(Config())(text) is found


def test_settings_add_words_that_make_a_module_relevant():
    assert endpoint_words(Config(tf2=True))("tf.lookupTransform(a, b)")
    assert endpoint_words(Config(), clients=True)("rospy.ServiceProxy('a', F)")
    assert endpoint_words(Config(sources=("bus.listen",)))("listen('a', f)")
    assert endpoint_words(Config(sinks=("bus.send",)))("bus.send(1)")
    assert endpoint_words(Config(wrappers=(Wrapper("bus.hear", "rospy.Subscriber"),)))("hear(f)")
    assert not endpoint_words(Config(sources=("bus.listen",)))("listened = 1")


def scripts(**texts: str) -> list[Script]:
    """Return modules; in a name, `__` stands for a dot, and a trailing `__init` for a package's own file."""
    made = []
    for name, text in texts.items():
        package = name.endswith("__init")
        dotted = name.removesuffix("__init").replace("__", ".")
        path = dotted.replace(".", "/") + ("/__init__.py" if package else ".py")
        made.append(Script(path, dotted, text, package))
    return made


def grouped(**texts: str) -> list[list[str]]:
    return [[one.name for one in group] for group in groups(scripts(**texts), Config())]


def test_group_lists_imported_modules_first():
    assert grouped(a=PUBLISHER + "import b\n", b="import c\n", c="x = 1\n", d="import e\n", e="x = 1\n") == [
        ["c", "b", "a"]
    ]
    assert grouped(a="import b\n", b=PUBLISHER, c="import b\n") == [["b", "a", "c"]]
    assert grouped(a="import b\n", b="x = 1\n") == []
    assert grouped(a=PUBLISHER, b=PUBLISHER) == [["a"], ["b"]]
    assert sorted(grouped(a=PUBLISHER + "import b", b="import a")[0]) == ["a", "b"], "imports in a circle"


@pytest.mark.parametrize(
    "statement",
    [
        "import p.m",
        "import q, p.m",
        "import q, \\\n    p.m as n",
        "from p import m",
        "from p import x, m as n",
        "from p import (x,  # the first\n    m,\n)",
        "from p import \\\n    m",
        "from p.m import x",
        "def f():\n    from p import m",
        "try:\n    import p.m\nexcept ImportError:\n    pass",
        "if 1: import p.m",
    ],
)
def test_every_form_of_import_is_recognised(statement):
    found = grouped(a=f"{PUBLISHER}{statement}\n", p__m="x = 1\n", other="x = 1\n")
    assert found == [["p.m", "a"]]


@pytest.mark.parametrize(
    ("statement", "found"),
    [
        ("from . import m", True),
        ("from .m import x", True),
        ("from .. import p", False),
        ("from ..p import m", True),
        ("from .x import m", False),
        ("# import p.m", False),
    ],
)
def test_relative_imports_are_resolved_in_the_package(statement, found):
    made = grouped(p__a=f"{PUBLISHER}{statement}\n", p__m="x = 1\n")
    assert made == ([["p.m", "p.a"]] if found else [["p.a"]])


def test_relative_imports_in_init_start_at_its_package():
    assert grouped(p__init=f"{PUBLISHER}from . import m\n", p__m="x = 1\n") == [["p.m", "p"]]
    assert grouped(p__init=f"{PUBLISHER}from .x import m\n", p__m="x = 1\n") == [["p"]]


def test_relevant_modules_are_listed_once():
    main = PUBLISHER + "import b\nif __name__ == '__main__':\n    pass\n"
    every = scripts(a=main, c=main, b="x = 1\n", d="x = 1\n")
    assert len(groups(every, Config())) == 2
    assert [one.name for one in relevant(every, Config())] == ["b", "a", "c"]
    assert [one.name for one in mentioning(every, Config())] == ["a", "c"]
    assert concerned(every, Config())
    assert not concerned(every[2:], Config())
    assert groups(scripts(a="rospy.ServiceProxy('a', F)\n"), Config()) == []
    assert len(groups(scripts(a="rospy.ServiceProxy('a', F)\n"), Config(), clients=True)) == 1


def test_imported_modules_are_listed_in_the_given_order():
    first = scripts(a="import b\n")
    others = scripts(d="x = 1\n", c="x = 1\n", b="import c\n", e="import d\n")
    assert [one.name for one in reached(first, others)] == ["c", "b"]
    assert reached([], others) == []
