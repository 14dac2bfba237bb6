"""The indented JSON equals the output of Python's encoder."""

import json

from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.report.indented import Written, dumped
from tarl_lint.report.json import document
from tests.lint.reports import everything, text_of

LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
VALUES = st.recursive(LEAVES, lambda v: st.lists(v) | st.dictionaries(st.text(), v), max_leaves=30)


@given(VALUES)
def test_the_text_equals_the_output_of_json_dumps(value):
    assert dumped(value) == json.dumps(value, indent=1)


@given(VALUES)
def test_preserialised_parts_are_inserted_at_their_level(value):
    whole = dumped({"a": [Written(dumped(value, 2))]})
    assert whole == json.dumps({"a": [value]}, indent=1)


def test_the_json_report_parses_to_the_document(example):
    result = everything(example)
    assert text_of("json", result) == json.dumps(document(result), indent=1) + "\n"
