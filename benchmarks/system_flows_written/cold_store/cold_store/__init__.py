"""Nodes of a cold store: climate, fans and logbook."""
