"""Search for a mutation (a changed constant) and its guard (a condition), and run the acceptance test of the repair."""
