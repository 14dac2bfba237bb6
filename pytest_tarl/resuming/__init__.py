"""`--tarl-resume`: keep every finished episode of a run, and continue an interrupted run with them."""
