"""Observe a node on a robot: append its steps, sensor values and rewards to a log, which `--tarl-log` reads."""
