"""Stress test (`--tarl-stress`): find the smallest drifts under which the guarantee of a recording fails."""
