"""Analyse a node in memory, and compare its flows with the marks in its comments."""

from __future__ import annotations

import re
from collections.abc import Iterable
from textwrap import dedent, indent

from tarl_lint import engine
from tarl_lint.model import Flow
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

NODE = """\
import rospy
from std_msgs.msg import Float64
{head}
out = rospy.Publisher("out", Float64, queue_size=1)

def on(msg):
{body}

rospy.Subscriber("in", Float64, on)
rospy.spin()
"""
MARK = re.compile(r"# (data|control|both|clean)$")
TOPICS = re.compile(r"# (clean|\S+:(?:data|control)(?: \S+:(?:data|control))*)$")
NAMES = {"explicit": "data", "implicit": "control"}
KINDS = {"data": ["explicit"], "control": ["implicit"], "both": ["explicit", "implicit"], "clean": []}


def flows(text: str, config: Config | None = None) -> list[Flow]:
    """Return the flows of a node given as text."""
    module = parse("node.py", text.encode(), "node")
    assert isinstance(module, Module)
    return engine.analyse([module], config or Config())


def in_callback(body: str, head: str = "") -> str:
    """Return a node whose callback `on(msg)` has this body; it publishes with `out`."""
    return NODE.format(head=dedent(head).strip(), body=indent(dedent(body).strip(), "    "))


def differing(text: str, found: Iterable[Flow] | None = None) -> dict[str, list[str]]:
    """Return the lines whose flows differ from their mark, with the flows.

    A line marked `# data` has explicit flows only, `# control` implicit ones, `# both` both, `# clean` none. A flow to
    a line without a mark differs.
    """
    lines = text.split("\n")
    wanted = {
        number: KINDS[mark[1]]
        for number, line in enumerate(lines, 1)
        if (mark := MARK.search(line)) is not None
    }
    assert wanted
    kinds: dict[int, set[str]] = {number: set() for number in wanted}
    for flow in flows(text) if found is None else found:
        kinds.setdefault(flow.sink.span.line, set()).add(flow.kind)
    return {
        lines[number - 1].strip(): sorted(found)
        for number, found in kinds.items()
        if sorted(found) != wanted.get(number)
    }


def sections(texts: str) -> dict[str, str]:
    """Return the texts below lines `### title`, by their titles."""
    return dict(part.split("\n", 1) for part in texts.split("### ")[1:])


def differing_topics(text: str, found: Iterable[Flow] | None = None) -> dict[str, str]:
    """Return the lines whose flows differ from their mark, with the flows.

    A mark names each topic whose messages reach the line, with the kind of the flow: `# scan:data stop:control`, or
    `# clean`. A flow to a line without a mark differs.
    """
    lines = text.split("\n")
    wanted = {n: mark[1] for n, line in enumerate(lines, 1) if (mark := TOPICS.search(line)) is not None}
    assert wanted
    kinds: dict[int, set[str]] = {number: set() for number in wanted}
    for flow in flows(text) if found is None else found:
        at = kinds.setdefault(flow.sink.span.line, set())
        at |= {f"{topic.strip('/')}:{NAMES[flow.kind]}" for topic in flow.source.topics or ("?",)}
    shown = {number: " ".join(sorted(ends)) or "clean" for number, ends in kinds.items()}
    return {
        lines[number - 1].strip(): ends
        for number, ends in shown.items()
        if sorted(ends.split()) != sorted(wanted.get(number, "").split())
    }
