"""Observe a node on a robot: write its steps, sensor values and rewards to a log for `--tarl-log`."""
