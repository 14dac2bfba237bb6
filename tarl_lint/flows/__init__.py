"""Flows and their steps, computed from the value-flow graph."""
