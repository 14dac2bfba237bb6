"""Learn from recorded episodes: statistics, utility, recordings, comparison of worlds, ranking of code."""
