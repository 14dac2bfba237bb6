"""Watch endless missions for a loss or a change of the world."""
