"""Stress test (`--tarl-stress`): find the smallest drifts that break the guarantee of a recording."""
