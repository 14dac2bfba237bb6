"""Learn from traces: statistics, utility, recordings, comparison, slices."""
