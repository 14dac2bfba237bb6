"""From traces to what they say: statistics, utility, fixture, comparison, slices."""
