"""Analyse the nodes of a launch file as one system: their topics, and the flows across nodes."""
