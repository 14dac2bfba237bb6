"""Instrument nodes: number the sites (statements to record), transform the code, and record one trace per episode."""
