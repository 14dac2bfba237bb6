"""An example of TARL: planner and gate."""
