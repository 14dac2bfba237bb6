"""Instrument nodes: number the sites of taint lists, transform the code, and record one trace per episode."""
