"""`--tarl-repair`: search for a mutation and its guard (condition), test them on fresh seeds, write the patch."""
