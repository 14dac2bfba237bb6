"""`--tarl-repair`: search for a mutation and its guard (condition), test both on fresh seeds, write the patch."""
