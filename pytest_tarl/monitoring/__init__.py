"""Watch an unbounded sequence of missions for a loss of performance and for a change of the world."""
