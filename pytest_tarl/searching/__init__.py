"""Search for a mutation (a changed constant) and its guard (a condition), and test the repair."""
