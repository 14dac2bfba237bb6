"""Search for a mutation and its guard, and test whether the repair holds."""
