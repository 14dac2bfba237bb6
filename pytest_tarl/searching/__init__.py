"""Search for a mutation and its guard, and run the acceptance test of the repair."""
