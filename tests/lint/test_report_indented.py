"""The indented JSON is what Python's encoder writes."""

import json

from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.report.indented import Written, dumped
from tarl_lint.report.json import document
from tests.lint.reports import everything, text_of

LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
VALUES = st.recursive(LEAVES, lambda v: st.lists(v) | st.dictionaries(st.text(), v), max_leaves=30)


@given(VALUES)
def test_it_writes_what_python_writes(value):
    assert dumped(value) == json.dumps(value, indent=1)


@given(VALUES)
def test_what_is_written_already_stands_where_it_was_written_for(value):
    whole = dumped({"a": [Written(dumped(value, 2))]})
    assert whole == json.dumps({"a": [value]}, indent=1)


def test_the_report_is_the_document(example):
    result = everything(example)
    assert text_of("json", result) == json.dumps(document(result), indent=1) + "\n"
