"""Watch endless missions for a loss of performance or a change of the world."""
