"""An interpreter with one empty state, and a frame of it."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config


@pytest.fixture
def ctx() -> Interpreter:
    text = "def f():\n    return 1\n"
    made = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
    made.store = Store(made.shared, Root("test", "test"))
    return made


@pytest.fixture
def graph(ctx) -> Graph:
    return ctx.graph


@pytest.fixture
def frame(ctx) -> Frame:
    (program,) = ctx.programs.values()
    return Frame("frame", 1, program.function, program, ctx.module_objects[program.name])
