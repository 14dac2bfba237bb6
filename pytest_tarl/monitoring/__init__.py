"""Watch an endless sequence of missions for a loss of performance and for a change of the world."""
