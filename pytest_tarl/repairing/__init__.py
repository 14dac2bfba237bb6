"""`--tarl-repair`: search a mutation, find its guard, accept it on fresh seeds, write the patch."""
