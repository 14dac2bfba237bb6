"""Monitor a stream of missions for a loss of performance or a change of the world."""
