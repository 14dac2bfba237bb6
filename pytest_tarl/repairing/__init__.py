"""`--tarl-repair`: search for a mutation and its guard, accept it on fresh seeds, and write the patch."""
