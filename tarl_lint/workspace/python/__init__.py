"""Interpret Python files of a workspace whose values are constant, without executing code."""
